//! Landmarks and turns in the order of the walk.

use super::{
    align::{Step, align},
    finding, pass,
};
use crate::{
    evidence::Evidence,
    reading::{Event, Reading, What},
};
use wayword_core::{Check, Finding, Side, Verdict};

/// What was found about the order of a text.
pub(super) struct Order {
    pub(super) findings: Vec<Finding>,
    /// The frame of each event of the reading, where it has one.
    pub(super) frames: Vec<Option<usize>>,
}

/// Checks the order of places by themselves, then that of turns among them. `shown` holds the frames of each event.
pub(super) fn order(reading: &Reading, evidence: &Evidence, shown: &[Vec<usize>]) -> Order {
    let sequence = in_order_of_walk(&reading.events);
    let steps: Vec<Step> = sequence
        .iter()
        .map(|at| if is_aside(reading, *at) { Step::Free } else { step(&reading.events[*at], &shown[*at], evidence) })
        .collect();
    let places_alone: Vec<Step> =
        steps.iter().map(|step| if matches!(step, Step::Turn(_)) { Step::Free } else { step.clone() }).collect();
    let span = |at: usize| Some(reading.events[sequence[at]].span);

    let mut findings = Vec::new();
    let mut laid = align(&steps, evidence);
    match align(&places_alone, evidence) {
        Err(at) => {
            findings.push(finding(
                Check::Order,
                Verdict::Fail,
                "it comes too late in the text: the path passed it before",
                span(at),
            ));
            findings.push(turns_alone(reading, evidence));
            laid = Err(at);
        }
        Ok(places) => {
            findings.push(pass(Check::Order));
            match &laid {
                Ok(_) => findings.push(pass(Check::Turns)),
                Err(at) => findings.push(finding(Check::Turns, Verdict::Fail, turn_reason(&steps, *at), span(*at))),
            }
            laid = laid.or(Ok(places));
        }
    }
    let mut frames = vec![None; reading.events.len()];
    for (at, frame) in sequence.iter().zip(laid.unwrap_or_default()) {
        frames[*at] = frame;
    }
    Order { findings, frames }
}

/// Whether an event is a place that only tells where another place of its clause, or the task's object, is.
fn is_aside(reading: &Reading, at: usize) -> bool {
    let event = &reading.events[at];
    let What::Place(place) = &event.what else { return false };
    let object = reading.task.as_ref().and_then(|task| task.object);
    let other_in_clause =
        reading.events[..at].iter().any(|other| other.clause == event.clause && matches!(other.what, What::Place(_)));
    (place.related && other_in_clause) || object.is_some_and(|object| object < at)
}

fn turn_reason(steps: &[Step], at: usize) -> &'static str {
    match &steps[at] {
        Step::Turn(Side::Left) => "no move of the path turns left here",
        Step::Turn(Side::Right) => "no move of the path turns right here",
        Step::Turn(_) => "no move of the path turns around here",
        _ => "the path turns differently before it gets here",
    }
}

/// Turns by themselves, where the places are out of order anyway.
fn turns_alone(reading: &Reading, evidence: &Evidence) -> Finding {
    let turns: Vec<&Event> = reading.events.iter().filter(|event| matches!(event.what, What::Turn(_))).collect();
    let steps: Vec<Step> = turns.iter().map(|event| step(event, &[], evidence)).collect();
    match align(&steps, evidence) {
        Ok(_) => pass(Check::Turns),
        Err(at) => finding(Check::Turns, Verdict::Fail, turn_reason(&steps, at), Some(turns[at].span)),
    }
}

fn step(event: &Event, shown: &[usize], evidence: &Evidence) -> Step {
    match &event.what {
        What::Turn(side) => Step::Turn(*side),
        What::Place(_) if !shown.is_empty() => Step::Place(shown.to_vec()),
        What::Climb(climb) => {
            let frames = evidence.frames_with_climb(*climb);
            if frames.is_empty() { Step::Free } else { Step::Place(frames) }
        }
        What::Place(_) | What::Floor(_) => Step::Free,
    }
}

/// The events in the order in which the walk meets them: a place that tells where a turn happens comes before that turn.
fn in_order_of_walk(events: &[Event]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..events.len()).collect();
    for at in 1..events.len() {
        let tells_turn = matches!(&events[at].what, What::Place(place) if place.tells_turn);
        if tells_turn && matches!(events[order[at - 1]].what, What::Turn(_)) {
            order.swap(at - 1, at);
        }
    }
    order
}

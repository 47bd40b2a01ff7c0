//! Checks that landmarks and turns come in the order of the path.

use super::{
    align::{Step, align},
    finding,
    landmarks::Shown,
    pass,
};
use crate::evidence::Evidence;
use wayword_core::{Check, Finding, Side, Verdict};
use wayword_language::reading::{Event, Link, Reading, What};

/// The findings about the order of a text.
pub(super) struct Order {
    pub(super) findings: Vec<Finding>,
    /// The frame of each event of the reading, where it has one.
    pub(super) frames: Vec<Option<usize>>,
}

/// Checks the order of the places first, then the order of the turns among them.
pub(super) fn order(reading: &Reading, evidence: &Evidence, shown: &[Shown]) -> Order {
    let sequence = in_order_of_walk(&reading.events);
    let asides = asides(reading);
    let steps_with = |frames: &dyn Fn(&Shown) -> Vec<usize>| -> Vec<Step> {
        let step_of = |at: &usize| match asides[*at] {
            true => Step::Free,
            false => step(&reading.events[*at], frames(&shown[*at]), evidence),
        };
        sequence.iter().map(step_of).collect()
    };
    let certain = steps_with(&|shown| shown.frames.clone());
    let possible = steps_with(&|shown| {
        let mut frames = [shown.frames.as_slice(), if shown.frames.is_empty() { &[] } else { &shown.unknown }].concat();
        frames.sort_unstable();
        frames
    });
    let span = |at: usize| Some(reading.events[sequence[at]].span);

    let (places, laid_places) = lay(&places_alone(&certain), &places_alone(&possible), evidence);
    let (findings, laid) = match laid_places {
        Err(at) => {
            let reason = match places {
                Verdict::Fail => "it comes too late in the text: the path passed it before",
                _ => "the path passed it earlier, and the program cannot check whether the path passes it again here",
            };
            (vec![finding(Check::Order, places, reason, span(at)), turns_alone(reading, evidence)], None)
        }
        Ok(laid_places) => match lay(&certain, &possible, evidence) {
            (_, Ok(laid)) => (vec![pass(Check::Order), no_wrong_turn(reading, evidence)], Some(laid)),
            (turns, Err(at)) => {
                let wrong = finding(Check::Turns, turns, turn_reason(&certain, at), span(at));
                (vec![pass(Check::Order), wrong], Some(laid_places))
            }
        },
    };
    let mut frames = vec![None; reading.events.len()];
    for (at, frame) in sequence.iter().zip(laid.unwrap_or_default()) {
        frames[*at] = frame;
    }
    Order { findings, frames }
}

/// Maps steps to the path. A text that does not fit fails only if it would not fit either if the unknown frames showed
/// its places.
fn lay(certain: &[Step], possible: &[Step], evidence: &Evidence) -> (Verdict, Result<Vec<Option<usize>>, usize>) {
    let laid = align(certain, evidence);
    let verdict = match &laid {
        Ok(_) => Verdict::Pass,
        Err(_) if align(possible, evidence).is_ok() => Verdict::Unverified,
        Err(_) => Verdict::Fail,
    };
    (verdict, laid)
}

fn places_alone(steps: &[Step]) -> Vec<Step> {
    steps
        .iter()
        .map(|step| if matches!(step, Step::Turn(_) | Step::Onward) { Step::Free } else { step.clone() })
        .collect()
}

/// For each event, whether it is a place that only locates another place of its clause, or the task's object.
fn asides(reading: &Reading) -> Vec<bool> {
    let object = reading.task.as_ref().and_then(|task| task.object);
    // The clause's number, whether it has named a place so far, and whether it has named a goal.
    let (mut clause, mut tells_place, mut tells_goal) = (0, false, false);
    let is_aside = |(at, event): (usize, &Event)| {
        if event.clause != clause {
            (clause, tells_place, tells_goal) = (event.clause, false, false);
        }
        let What::Place(place) = &event.what else { return false };
        let tells_where = match place.link {
            Link::Within | Link::Beside => tells_place,
            // "To the bathroom past the kitchen": the goal is named first, and reached last.
            Link::Along => tells_goal,
            Link::Plain | Link::Goal => false,
        };
        tells_place = true;
        tells_goal |= place.link == Link::Goal;
        tells_where || object.is_some_and(|object| object < at)
    };
    reading.events.iter().enumerate().map(is_aside).collect()
}

fn turn_reason(steps: &[Step], at: usize) -> &'static str {
    match &steps[at] {
        Step::Turn(Side::Left) => "no move of the path turns left here",
        Step::Turn(Side::Right) => "no move of the path turns right here",
        Step::Turn(_) => "no move of the path turns around here",
        Step::Onward => "the path does not go anywhere",
        _ => "the path turns differently before it gets here",
    }
}

/// The turns alone, where the places are out of order anyway.
fn turns_alone(reading: &Reading, evidence: &Evidence) -> Finding {
    let turns: Vec<&Event> =
        reading.events.iter().filter(|event| matches!(event.what, What::Turn(_) | What::Onward)).collect();
    let steps: Vec<Step> = turns.iter().map(|event| step(event, Vec::new(), evidence)).collect();
    match align(&steps, evidence) {
        Ok(_) => no_wrong_turn(reading, evidence),
        Err(at) => finding(Check::Turns, Verdict::Fail, turn_reason(&steps, at), Some(turns[at].span)),
    }
}

/// The finding on a text without a wrong turn: where the motion is unknown, its turns are unverified.
fn no_wrong_turn(reading: &Reading, evidence: &Evidence) -> Finding {
    let first = reading.events.iter().find(|event| matches!(event.what, What::Turn(_)));
    match first.filter(|_| !evidence.motion.is_known()) {
        Some(turn) => {
            let reason = "the program cannot check how the path turns";
            finding(Check::Turns, Verdict::Unverified, reason, Some(turn.span))
        }
        None => pass(Check::Turns),
    }
}

fn step(event: &Event, shown: Vec<usize>, evidence: &Evidence) -> Step {
    match &event.what {
        What::Turn(_) if !evidence.motion.is_known() => Step::Free,
        What::Turn(side) => Step::Turn(*side),
        What::Place(_) if !shown.is_empty() => Step::Place(shown),
        What::Climb(climb) => {
            let frames = evidence.frames_with_climb(*climb);
            if frames.is_empty() { Step::Free } else { Step::Place(frames) }
        }
        What::Onward => Step::Onward,
        What::Place(_) | What::Steps(_) | What::Storey(_) | What::Floor(_) => Step::Free,
        What::Stop | What::Face { .. } | What::Compass { .. } | What::Distance { .. } => Step::Free,
    }
}

/// The events in the order in which the path meets them: the place of a turn comes before that turn.
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

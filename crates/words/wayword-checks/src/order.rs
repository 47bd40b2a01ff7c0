//! Checks that landmarks and turns come in the order of the path.

use super::{
    align::{AlignmentStep, align_steps},
    landmarks::ShownFrames,
    new_finding, pass_finding,
};
use crate::evidence::Evidence;
use wayword_core::{CheckFinding, CheckKind, Side, Verdict};
use wayword_language::{
    reading::{EventContent, PlaceLink, TextEvent, TextReading},
    text::TextToken,
};

/// The findings about the order of a text.
pub(super) struct OrderFindings {
    pub(super) findings: Vec<CheckFinding>,
    /// The frame of each event of the reading, where it has one.
    pub(super) frames: Vec<Option<usize>>,
}

/// Checks the order of the places first, then the order of the turns among them.
pub(super) fn check_order(reading: &TextReading, evidence: &Evidence, shown: &[ShownFrames]) -> OrderFindings {
    let sequence = order_by_walk(&reading.events);
    let asides = find_asides(reading);
    let steps_with = |frames: &dyn Fn(&ShownFrames) -> Vec<usize>| -> Vec<AlignmentStep> {
        let step_at = |at: &usize| match asides[*at] {
            true => AlignmentStep::Free,
            false => step_for(&reading.events[*at], frames(&shown[*at]), evidence),
        };
        sequence.iter().map(step_at).collect()
    };
    // The steps with the frames that show their places, and with those that may show them where no frame does.
    let certain = steps_with(&|shown| shown.frames.clone());
    let possible = steps_with(&|shown| {
        let mut frames = [shown.frames.as_slice(), if shown.frames.is_empty() { &[] } else { &shown.unknown }].concat();
        frames.sort_unstable();
        frames
    });
    let span = |at: usize| Some(reading.events[sequence[at]].span);

    let (places, laid_places) = lay_steps(&places_alone(&certain), &places_alone(&possible), evidence);
    let (findings, laid) = match laid_places {
        Err(at) => {
            let reason = match places {
                Verdict::Fail => "it comes too late in the text: the path passed it before",
                _ => "the path passed it earlier, and the program cannot check whether the path passes it again here",
            };
            (vec![new_finding(CheckKind::Order, places, reason, span(at)), turns_alone(reading, evidence)], None)
        }
        Ok(laid_places) => match lay_steps(&certain, &possible, evidence) {
            (_, Ok(laid)) => (vec![pass_finding(CheckKind::Order), no_wrong_turn(reading, evidence)], Some(laid)),
            (turns, Err(at)) => {
                let wrong = new_finding(CheckKind::Turns, turns, turn_reason(&certain, at), span(at));
                (vec![pass_finding(CheckKind::Order), wrong], Some(laid_places))
            }
        },
    };
    let mut frames = vec![None; reading.events.len()];
    for (at, frame) in sequence.iter().zip(laid.unwrap_or_default()) {
        frames[*at] = frame;
    }
    OrderFindings { findings, frames }
}

/// Maps steps to the path. A text that does not fit fails only if it would not fit either if the unknown frames showed
/// its places.
fn lay_steps(
    certain: &[AlignmentStep],
    possible: &[AlignmentStep],
    evidence: &Evidence,
) -> (Verdict, Result<Vec<Option<usize>>, usize>) {
    let laid = align_steps(certain, evidence);
    let verdict = match &laid {
        Ok(_) => Verdict::Pass,
        Err(_) if align_steps(possible, evidence).is_ok() => Verdict::Unverified,
        Err(_) => Verdict::Fail,
    };
    (verdict, laid)
}

/// The steps without their turns.
fn places_alone(steps: &[AlignmentStep]) -> Vec<AlignmentStep> {
    steps
        .iter()
        .map(|step| if matches!(step, AlignmentStep::Turn(_)) { AlignmentStep::Free } else { step.clone() })
        .collect()
}

/// For each event, whether it is a place that only locates another place of its clause, or the task's object.
fn find_asides(reading: &TextReading) -> Vec<bool> {
    let object = reading.task.as_ref().and_then(|task| task.object);
    // The clause's number, whether it has named a place so far, and whether it has named a goal or a flight.
    let (mut clause, mut tells_place, mut tells_goal) = (0, false, false);
    let is_aside = |(at, event): (usize, &TextEvent)| {
        if event.clause != clause {
            clause = event.clause;
            // "Go up the stairs, past the pictures" has no command behind the comma.
            if !begins_beside(reading, at) {
                (tells_place, tells_goal) = (false, false);
            }
        }
        let EventContent::Place(place) = &event.what else {
            // "Go up the stairs, past the pictures": they hang beside the flight.
            tells_goal |= matches!(event.what, EventContent::Climb(_));
            return false;
        };
        let tells_where = match place.link {
            PlaceLink::Within | PlaceLink::Beside => tells_place,
            // "To the bathroom past the kitchen": the goal is named first, and reached last.
            PlaceLink::Along => tells_goal,
            PlaceLink::Plain | PlaceLink::Goal => false,
        };
        tells_place = true;
        tells_goal |= place.link == PlaceLink::Goal;
        tells_where || object.is_some_and(|object| object < at)
    };
    reading.events.iter().enumerate().map(is_aside).collect()
}

/// Whether the words behind the event before this one begin with where the way lies ("..., past the pictures").
fn begins_beside(reading: &TextReading, at: usize) -> bool {
    let from = at.checked_sub(1).map_or(0, |before| reading.events[before].span[1]);
    let mut behind = reading.tokens().iter().filter(|token| token.span[0] >= from);
    let is_and = |token: &&TextToken| matches!(token.word.as_str(), "," | "and");
    behind.find(|token| !is_and(token)).is_some_and(|token| matches!(token.word.as_str(), "past" | "along" | "by"))
}

/// Why the walk of a text ends at a step: the reason of a finding about turns.
fn turn_reason(steps: &[AlignmentStep], at: usize) -> &'static str {
    match &steps[at] {
        AlignmentStep::Turn(Side::Left) => "no move of the path turns left here",
        AlignmentStep::Turn(Side::Right) => "no move of the path turns right here",
        AlignmentStep::Turn(_) => "no move of the path turns around here",
        _ => "the path turns differently before it gets here",
    }
}

/// The finding on the turns alone, where the places are out of order anyway.
fn turns_alone(reading: &TextReading, evidence: &Evidence) -> CheckFinding {
    let turns: Vec<&TextEvent> =
        reading.events.iter().filter(|event| matches!(event.what, EventContent::Turn(_))).collect();
    let steps: Vec<AlignmentStep> = turns.iter().map(|event| step_for(event, Vec::new(), evidence)).collect();
    match align_steps(&steps, evidence) {
        Ok(_) => no_wrong_turn(reading, evidence),
        Err(at) => new_finding(CheckKind::Turns, Verdict::Fail, turn_reason(&steps, at), Some(turns[at].span)),
    }
}

/// The finding on a text without a wrong turn: where the motion is unknown, its turns are unverified.
fn no_wrong_turn(reading: &TextReading, evidence: &Evidence) -> CheckFinding {
    let first = reading.events.iter().find(|event| matches!(event.what, EventContent::Turn(_)));
    match first.filter(|_| !evidence.motion.is_known()) {
        Some(turn) => {
            let reason = "the program cannot check how the path turns";
            new_finding(CheckKind::Turns, Verdict::Unverified, reason, Some(turn.span))
        }
        None => pass_finding(CheckKind::Turns),
    }
}

/// The step that an event of the text asks for. `shown`: the frames that show its place.
fn step_for(event: &TextEvent, shown: Vec<usize>, evidence: &Evidence) -> AlignmentStep {
    match &event.what {
        EventContent::Turn(_) if !evidence.motion.is_known() => AlignmentStep::Free,
        EventContent::Turn(side) => AlignmentStep::Turn(*side),
        EventContent::Place(_) if !shown.is_empty() => AlignmentStep::Place(shown),
        EventContent::Climb(climb) => {
            let frames = evidence.frames_with_climb(*climb);
            if frames.is_empty() { AlignmentStep::Free } else { AlignmentStep::Place(frames) }
        }
        EventContent::Onward
        | EventContent::Place(_)
        | EventContent::Steps(_)
        | EventContent::Storey(_)
        | EventContent::Floor(_) => AlignmentStep::Free,
        EventContent::Stop
        | EventContent::Face { .. }
        | EventContent::Compass { .. }
        | EventContent::Distance { .. } => AlignmentStep::Free,
    }
}

/// The events in the order in which the path meets them: the place of a turn comes before that turn.
fn order_by_walk(events: &[TextEvent]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..events.len()).collect();
    for at in 1..events.len() {
        let tells_turn = matches!(&events[at].what, EventContent::Place(place) if place.tells_turn);
        if tells_turn && matches!(events[order[at - 1]].what, EventContent::Turn(_)) {
            order.swap(at - 1, at);
        }
    }
    order
}

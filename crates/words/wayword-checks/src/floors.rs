//! Checks storeys and stairs: climbs that the path does not make, and storeys that it does not pass.

use super::{findings_or_pass, new_finding};
use crate::evidence::Evidence;
use wayword_core::{CheckFinding, CheckKind, ClimbDirection, PathMotion, Verdict};
use wayword_language::reading::{EventContent, StoreyMention, TextEvent, TextReading};

/// The findings about the stairs and storeys of a text: a pass if all of them fit the path.
pub(super) fn check_floors(reading: &TextReading, evidence: &Evidence) -> Vec<CheckFinding> {
    let stairs = reading.events.iter().filter_map(|event| {
        let (verdict, wrong) = match event.what {
            EventContent::Climb(climb) => {
                (verdict_on_climb(climb, evidence), format!("the path does not go {} any stairs", way_word(climb)))
            }
            EventContent::Steps(climb) => {
                (verdict_on_steps(climb, evidence), format!("the path does not go {} any steps", way_word(climb)))
            }
            EventContent::Storey(climb) => {
                (verdict_on_storey(climb, evidence), format!("the path does not end {} any stairs", way_word(climb)))
            }
            _ => return None,
        };
        let unknown = || "the program cannot check whether the path goes up or down".to_owned();
        let reason = if verdict == Verdict::Fail { wrong } else { unknown() };
        (verdict != Verdict::Pass).then(|| new_finding(CheckKind::Floors, verdict, reason, Some(event.span)))
    });
    findings_or_pass(CheckKind::Floors, stairs.chain(wrong_floors(reading, evidence)).collect())
}

/// The first storey of a text that is wrong or cannot be checked.
pub(super) fn wrong_floors(reading: &TextReading, evidence: &Evidence) -> Option<CheckFinding> {
    let levels: Vec<Option<u32>> = evidence.frames.iter().map(|frame| frame.level).collect();
    wrong_floor(&named_floors(reading), reading, &levels)
}

fn way_word(climb: ClimbDirection) -> &'static str {
    if climb == ClimbDirection::Up { "up" } else { "down" }
}

fn verdict_on_climb(climb: ClimbDirection, evidence: &Evidence) -> Verdict {
    climb_verdict(!evidence.frames_with_climb(climb).is_empty(), evidence)
}

fn verdict_on_steps(climb: ClimbDirection, evidence: &Evidence) -> Verdict {
    climb_verdict(evidence.has_steps(climb), evidence)
}

/// A climb that the moves do not make is wrong where the motion is known.
fn climb_verdict(climbs: bool, evidence: &Evidence) -> Verdict {
    match (climbs, evidence.motion) {
        (true, _) => Verdict::Pass,
        (false, PathMotion::Known) => Verdict::Fail,
        (false, PathMotion::Unknown) => Verdict::Unverified,
    }
}

/// "The bedroom upstairs" is right for a path that ends upstairs (on storey 2 or higher), wherever it starts.
fn verdict_on_storey(climb: ClimbDirection, evidence: &Evidence) -> Verdict {
    let ends_there = match evidence.frames.last().and_then(|frame| frame.level) {
        Some(level) => (level >= 2) == (climb == ClimbDirection::Up),
        None if verdict_on_climb(climb, evidence) != Verdict::Pass => return Verdict::Unverified,
        None => true,
    };
    if ends_there { Verdict::Pass } else { verdict_on_climb(climb, evidence) }
}

/// The storeys that a text names, in the order of the path.
fn named_floors(reading: &TextReading) -> Vec<(&TextEvent, StoreyMention)> {
    let mut named: Vec<(&TextEvent, StoreyMention)> = Vec::new();
    for event in &reading.events {
        let EventContent::Floor(floor) = event.what else { continue };
        if floor.aside {
            continue;
        }
        // "To the second floor from the first": the text names the storey that the path leaves last, not first.
        let is_start =
            named.last().is_some_and(|(before, other)| floor.leaves && !other.leaves && before.clause == event.clause);
        named.insert(named.len() - usize::from(is_start), (event, floor));
    }
    named
}

/// The first wrong storey of a text. The path has to pass the storeys in their order, and to end on the last one where
/// the text names that as the goal.
fn wrong_floor(
    named: &[(&TextEvent, StoreyMention)],
    reading: &TextReading,
    levels: &[Option<u32>],
) -> Option<CheckFinding> {
    let wrong = |verdict: Verdict, (event, floor): &(&TextEvent, StoreyMention)| {
        let name = floor.number.map_or("the top storey".to_owned(), |number| format!("storey {number}"));
        let touched = floor.number.is_some_and(|number| levels.contains(&Some(number)));
        let reason = match (verdict, touched) {
            (Verdict::Fail, true) => format!("the path is on {name}, but not at this point of the text"),
            (Verdict::Fail, false) => format!("the path is never on {name}"),
            _ => format!("the program cannot check whether the path is on {name}"),
        };
        new_finding(CheckKind::Floors, verdict, reason, Some(event.span))
    };
    // Whether the path has to end on a storey: no other storey and no climb follows it.
    let is_goal = |at: usize| {
        let (event, floor) = named[at];
        let goes_on = || {
            reading.events.iter().any(|other| {
                matches!(other.what, EventContent::Climb(_))
                    && other.span[0] > event.span[0]
                    && other.clause != event.clause
            })
        };
        at + 1 == named.len() && !floor.leaves && !goes_on()
    };
    // The first storey of the text that no frame from there on allows.
    let first_off = |allows: &dyn Fn(Option<u32>, StoreyMention) -> bool| {
        let mut from = 0;
        named.iter().enumerate().position(|(at, (_, floor))| {
            let first = if is_goal(at) { levels.len().saturating_sub(1).max(from) } else { from };
            let next = (first..levels.len()).find(|frame| allows(levels[*frame], *floor));
            from = next.unwrap_or(from);
            next.is_none()
        })
    };
    let highest = levels.iter().flatten().max().copied();
    let certain = |level: Option<u32>, floor: StoreyMention| floor.number.is_some() && level == floor.number;
    let possible = |level: Option<u32>, floor: StoreyMention| match (level, floor.number) {
        (None, _) => true,
        (Some(level), Some(number)) => level == number,
        // The building may have higher storeys than the path, but a storey below the path's highest is not the top one.
        (Some(level), None) => Some(level) == highest,
    };
    if let Some(at) = first_off(&possible) {
        return Some(wrong(Verdict::Fail, &named[at]));
    }
    first_off(&certain).map(|at| wrong(Verdict::Unverified, &named[at]))
}

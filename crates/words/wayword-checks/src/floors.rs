//! Checks storeys and stairs: climbs that the path does not make, and storeys that it does not pass.

use super::{finding, or_pass};
use crate::evidence::Evidence;
use wayword_core::{Check, Climb, Finding, Motion, Verdict};
use wayword_language::reading::{Event, Floor, Reading, What};

pub(super) fn floors(reading: &Reading, evidence: &Evidence) -> Vec<Finding> {
    let stairs = reading.events.iter().filter_map(|event| {
        let (verdict, wrong) = match event.what {
            What::Climb(climb) => (climbed(climb, evidence), format!("the path does not go {} any stairs", way(climb))),
            What::Steps(climb) => (stepped(climb, evidence), format!("the path does not go {} any steps", way(climb))),
            What::Storey(climb) => {
                (storey(climb, evidence), format!("the path does not end {} any stairs", way(climb)))
            }
            _ => return None,
        };
        let unknown = || "the program cannot check whether the path goes up or down".to_owned();
        let reason = if verdict == Verdict::Fail { wrong } else { unknown() };
        (verdict != Verdict::Pass).then(|| finding(Check::Floors, verdict, reason, Some(event.span)))
    });
    or_pass(Check::Floors, stairs.chain(wrong_floors(reading, evidence)).collect())
}

/// The first storey of a text that is wrong or cannot be checked.
pub(super) fn wrong_floors(reading: &Reading, evidence: &Evidence) -> Option<Finding> {
    let levels: Vec<Option<u32>> = evidence.frames.iter().map(|frame| frame.level).collect();
    wrong_floor(&told(reading), reading, &levels)
}

fn way(climb: Climb) -> &'static str {
    if climb == Climb::Up { "up" } else { "down" }
}

fn climbed(climb: Climb, evidence: &Evidence) -> Verdict {
    holds(!evidence.frames_with_climb(climb).is_empty(), evidence)
}

fn stepped(climb: Climb, evidence: &Evidence) -> Verdict {
    holds(evidence.steps(climb), evidence)
}

/// A climb that the moves do not make is wrong where the motion is known.
fn holds(climbs: bool, evidence: &Evidence) -> Verdict {
    match (climbs, evidence.motion) {
        (true, _) => Verdict::Pass,
        (false, Motion::Known) => Verdict::Fail,
        (false, Motion::Unknown) => Verdict::Unverified,
    }
}

/// "The bedroom upstairs" is right for a path that ends upstairs, wherever it starts.
fn storey(climb: Climb, evidence: &Evidence) -> Verdict {
    let ends_there = match evidence.frames.last().and_then(|frame| frame.level) {
        Some(level) => (level >= 2) == (climb == Climb::Up),
        None if climbed(climb, evidence) != Verdict::Pass => return Verdict::Unverified,
        None => true,
    };
    if ends_there { Verdict::Pass } else { climbed(climb, evidence) }
}

/// The storeys that a text names, in the order of the path.
fn told(reading: &Reading) -> Vec<(&Event, Floor)> {
    let mut told: Vec<(&Event, Floor)> = Vec::new();
    for event in &reading.events {
        let What::Floor(floor) = event.what else { continue };
        if floor.aside {
            continue;
        }
        // "To the second floor from the first".
        let behind =
            told.last().is_some_and(|(before, other)| floor.leaves && !other.leaves && before.clause == event.clause);
        told.insert(told.len() - usize::from(behind), (event, floor));
    }
    told
}

/// The first wrong storey of a text. The path has to pass the storeys in their order, and to end on the last one where
/// the text names that as the goal.
fn wrong_floor(told: &[(&Event, Floor)], reading: &Reading, levels: &[Option<u32>]) -> Option<Finding> {
    let wrong = |verdict: Verdict, (event, floor): &(&Event, Floor)| {
        let name = floor.number.map_or("the top storey".to_owned(), |number| format!("storey {number}"));
        let touched = floor.number.is_some_and(|number| levels.contains(&Some(number)));
        let reason = match (verdict, touched) {
            (Verdict::Fail, true) => format!("the path is on {name}, but not at this point of the text"),
            (Verdict::Fail, false) => format!("the path is never on {name}"),
            _ => format!("the program cannot check whether the path is on {name}"),
        };
        finding(Check::Floors, verdict, reason, Some(event.span))
    };
    let ends = |at: usize| {
        let (event, floor) = told[at];
        let goes_on = || {
            reading.events.iter().any(|other| {
                matches!(other.what, What::Climb(_)) && other.span[0] > event.span[0] && other.clause != event.clause
            })
        };
        at + 1 == told.len() && !floor.leaves && !goes_on()
    };
    // The first storey of the text that no frame from there on allows.
    let first_off = |allows: &dyn Fn(Option<u32>, Floor) -> bool| {
        let mut from = 0;
        told.iter().enumerate().position(|(at, (_, floor))| {
            let first = if ends(at) { levels.len().saturating_sub(1).max(from) } else { from };
            let found = (first..levels.len()).find(|frame| allows(levels[*frame], *floor));
            from = found.unwrap_or(from);
            found.is_none()
        })
    };
    let highest = levels.iter().flatten().max().copied();
    let certain = |level: Option<u32>, floor: Floor| floor.number.is_some() && level == floor.number;
    let possible = |level: Option<u32>, floor: Floor| match (level, floor.number) {
        (None, _) => true,
        (Some(level), Some(number)) => level == number,
        // The building may have higher storeys than the path, but a storey below the path's highest is not the top one.
        (Some(level), None) => Some(level) == highest,
    };
    if let Some(at) = first_off(&possible) {
        return Some(wrong(Verdict::Fail, &told[at]));
    }
    first_off(&certain).map(|at| wrong(Verdict::Unverified, &told[at]))
}

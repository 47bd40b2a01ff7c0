//! Checks storeys and stairs: climbs that the path does not make, and storeys that it does not pass.

use super::{findings_or_pass, new_finding};
use crate::evidence::Evidence;
use wayword_core::{CheckFinding, CheckKind, ClimbDirection, PathMotion, Verdict};
use wayword_language::reading::{EventContent, StoreyMention, TextEvent, TextReading};

/// The findings about the stairs and storeys of a text: a pass if all of them fit the path.
pub(super) fn check_floors(reading: &TextReading, evidence: &Evidence, tag: Option<&str>) -> Vec<CheckFinding> {
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
    findings_or_pass(CheckKind::Floors, stairs.chain(wrong_floors(reading, evidence, tag)).collect())
}

/// How a text counts storeys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum StoreyCount {
    /// The lowest storey is the first floor.
    FromFirst,
    /// The lowest storey is the ground floor, and the first floor lies above it.
    FromGround,
    /// One of both.
    Either,
}

/// The regions where the first floor lies above the ground floor.
const REGIONS_FROM_GROUND: [&str; 7] = ["in", "gb", "uk", "au", "nz", "ie", "za"];

impl StoreyCount {
    /// The count of a text by the tag of its language ("en-IN"). Without a region, a text that names both a ground floor and a numbered one may
    /// count in either way; any other counts from the first, as R2R's writers do.
    fn for_text(tag: Option<&str>, named: &[(&TextEvent, StoreyMention)], reading: &TextReading) -> Self {
        let region = tag.and_then(|tag| tag.split(['-', '_']).nth(1)).map(str::to_lowercase);
        match region {
            Some(region) if REGIONS_FROM_GROUND.contains(&region.as_str()) => Self::FromGround,
            Some(_) => Self::FromFirst,
            None => {
                let grounds = named.iter().filter(|(event, _)| is_ground(event, reading)).count();
                if grounds > 0 && grounds < named.len() { Self::Either } else { Self::FromFirst }
            }
        }
    }
}

/// Whether a storey is called the ground floor, or the bottom one.
fn is_ground(event: &TextEvent, reading: &TextReading) -> bool {
    let mut words =
        reading.tokens().iter().filter(|token| token.span[0] >= event.span[0] && token.span[1] <= event.span[1]);
    words.any(|token| matches!(token.word.as_str(), "ground" | "bottom"))
}

/// The first storey of a text that is wrong or cannot be checked. `tag` is the tag of its language, where its file names one.
pub(super) fn wrong_floors(reading: &TextReading, evidence: &Evidence, tag: Option<&str>) -> Option<CheckFinding> {
    let levels: Vec<Option<u32>> = evidence.frames.iter().map(|frame| frame.level).collect();
    let named = named_floors(reading);
    let from_first = || wrong_floor(&named, reading, &levels);
    let from_ground = || {
        let mut higher = named.clone();
        for (event, floor) in &mut higher {
            floor.number = floor.number.map(|number| number + u32::from(!is_ground(event, reading)));
        }
        wrong_floor(&higher, reading, &levels)
    };
    match StoreyCount::for_text(tag, &named, reading) {
        StoreyCount::FromFirst => from_first(),
        StoreyCount::FromGround => from_ground(),
        StoreyCount::Either => match (from_first(), from_ground()) {
            (None, None) => None,
            (Some(wrong), Some(other)) if wrong.verdict == other.verdict => Some(wrong),
            (one, other) => one.or(other).map(|finding| {
                let reason =
                    "the first floor is the lowest storey to some people, and the one above it to others".to_owned();
                new_finding(CheckKind::Floors, Verdict::Unverified, reason, finding.span)
            }),
        },
    }
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

//! Floors and stairs.

use super::{finding, or_pass};
use crate::{
    evidence::Evidence,
    reading::{Reading, What},
};
use wayword_core::{Check, Climb, Finding, Verdict};

pub(super) fn floors(reading: &Reading, evidence: &Evidence) -> Vec<Finding> {
    let levels: Vec<u32> = evidence.frames.iter().filter_map(|frame| frame.level).collect();
    let last = levels.last().copied();
    let wrong = reading.events.iter().filter_map(|event| {
        let (right, reason) = match event.what {
            What::Floor(_) if levels.is_empty() => (None, "no floor is known on this path".to_owned()),
            What::Floor(number) => (Some(levels.contains(&number)), format!("the path does not touch floor {number}")),
            What::Climb(climb) => {
                // "the bedroom upstairs" tells a place to somebody who stands anywhere.
                let is_there = last.is_some_and(|last| if climb == Climb::Up { last >= 2 } else { last == 1 });
                let climbs = !evidence.frames_with_climb(climb).is_empty();
                let way = if climb == Climb::Up { "up" } else { "down" };
                (Some(climbs || is_there), format!("the path does not go {way} any stairs"))
            }
            What::Place(_) | What::Turn(_) => return None,
        };
        let verdict = right.map_or(Verdict::Unverified, |right| if right { Verdict::Pass } else { Verdict::Fail });
        (verdict != Verdict::Pass).then(|| finding(Check::Floors, verdict, reason, Some(event.span)))
    });
    or_pass(Check::Floors, wrong.collect())
}

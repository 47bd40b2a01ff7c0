//! Each landmark needs a frame that shows it.

use super::{finding, or_pass, sides};
use crate::{
    evidence::{Evidence, Source},
    lexicon::{Class, agree, thing},
    reading::{Place, Reading, What},
};
use wayword_core::{Check, Finding, Target, Verdict};

/// What was found about the places of a text.
pub(super) struct Places {
    pub(super) findings: Vec<Finding>,
    /// For each event of the reading, the frames that show it; empty for what is no place or is not shown.
    pub(super) frames: Vec<Vec<usize>>,
}

pub(super) fn landmarks(reading: &Reading, evidence: &Evidence, target: Option<&Target>) -> Places {
    let object = reading.task.as_ref().and_then(|task| task.object);
    let (mut findings, mut frames) = (Vec::new(), Vec::new());
    for (at, event) in reading.events.iter().enumerate() {
        let What::Place(place) = &event.what else {
            frames.push(Vec::new());
            continue;
        };
        let is_object = object == Some(at);
        let shown = if is_object { at_the_end(place, evidence) } else { frames_of(place, evidence) };
        // The task check speaks about its object, and a given target may be out of sight.
        let given = is_object && target.is_some_and(|target| agree(&target.name, &place.name));
        if shown.is_empty() && !is_object && !given {
            let verdict = absent(place, evidence);
            let reason = match verdict {
                Verdict::Fail => format!("no frame of the path shows {:?}", place.name),
                _ => format!("nothing here can tell whether there is {:?}", place.name),
            };
            findings.push(finding(Check::Landmarks, verdict, reason, Some(event.span)));
        } else if let Some(side) = sides::wrong_side(place, &shown, evidence).filter(|_| !is_object) {
            let reason = format!("{:?} is not on the {} where the path passes it", place.name, sides::word(side));
            findings.push(finding(Check::Landmarks, Verdict::Fail, reason, Some(event.span)));
        }
        findings.extend(
            colour(place, &shown, evidence)
                .map(|(verdict, reason)| finding(Check::Landmarks, verdict, reason, Some(event.span))),
        );
        frames.push(shown);
    }
    if evidence.source == Source::Nothing && findings.is_empty() {
        findings.push(finding(
            Check::Landmarks,
            Verdict::Unverified,
            "nothing is known of what is seen along the path",
            None,
        ));
    }
    Places { findings: or_pass(Check::Landmarks, findings), frames }
}

/// What is wrong with the colour that a place is told with.
fn colour(place: &Place, frames: &[usize], evidence: &Evidence) -> Option<(Verdict, String)> {
    let told = place.colour.as_ref()?;
    let things =
        frames.iter().flat_map(|at| &evidence.frames[*at].things).filter(|thing| agree(&thing.name, &place.name));
    let known: Vec<&String> = things.filter_map(|thing| thing.colour.as_ref()).collect();
    // "the brown chair" for a dark brown one is no mistake.
    let fits = known.iter().any(|colour| {
        *colour == told || colour.ends_with(&format!(" {told}")) || told.ends_with(&format!(" {colour}"))
    });
    match (known.is_empty(), fits) {
        (_, true) => None,
        (true, false) if frames.is_empty() => None,
        (true, false) => {
            Some((Verdict::Unverified, format!("nothing here can tell whether {:?} is {told}", place.name)))
        }
        (false, false) => Some((Verdict::Fail, format!("no {:?} along the path is {told}", place.name))),
    }
}

fn frames_of(place: &Place, evidence: &Evidence) -> Vec<usize> {
    let mut frames = Vec::new();
    if place.is_room {
        frames.extend(evidence.frames_in_room(&place.name));
    }
    if place.is_thing {
        frames.extend(evidence.frames_with_thing(&place.name));
    }
    if thing(&place.name).is_some_and(|thing| thing.class == Class::Stairs) {
        frames.extend(evidence.frames_on_stairs());
    }
    frames.sort_unstable();
    frames.dedup();
    frames
}

fn at_the_end(place: &Place, evidence: &Evidence) -> Vec<usize> {
    let last = evidence.frames.len().saturating_sub(1);
    let shown = evidence.final_things().iter().any(|thing| agree(&thing.name, &place.name));
    if shown { vec![last] } else { Vec::new() }
}

/// What it means that no frame shows a place.
fn absent(place: &Place, evidence: &Evidence) -> Verdict {
    let thing_denied = place.is_thing && evidence.could_tell(&place.name);
    // What lies next to a path need not lie on it.
    let room_denied = place.is_room && evidence.knows_rooms() && !place.related;
    // A name that means either is denied where one of them is.
    if evidence.source != Source::Nothing && (thing_denied || (room_denied && !place.is_thing)) {
        Verdict::Fail
    } else {
        Verdict::Unverified
    }
}

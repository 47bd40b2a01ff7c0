//! Checks where a text ends: its last landmark has to be seen from the end and near it, and its last room has to be
//! the path's.

use super::finding;
use crate::evidence::{Evidence, FrameEvidence, Source};
use wayword_core::{Check, Finding, Verdict};
use wayword_language::{
    lexicon::{Class, agree, is_fabric, room_name, same_room, thing},
    reading::{Event, Link, Place, Reading, What},
};

/// "Stop by the sofa": its centre is no farther than this from the eye, metres. For things on the floor that is 2 m
/// along the floor.
const NEAR_M: f64 = 2.5;

/// The mistake at the end of a text, if there is one. `object`: the task's, which has a check of its own.
pub(super) fn goal(reading: &Reading, evidence: &Evidence, object: Option<usize>) -> Option<Finding> {
    if evidence.source == Source::Nothing {
        return None;
    }
    let last = evidence.frames.len().checked_sub(1)?;
    // Captions give no distances: a walker at the end may have passed the landmark by one step.
    let first = if evidence.source == Source::Labels { last } else { last.saturating_sub(1) };
    let near = &evidence.frames[first..];
    let wrong = |(at, place): (usize, &Place)| {
        let (verdict, reason) = match (place.is_room, place.is_thing) {
            (true, false) if place.link != Link::Beside => wrong_room(&place.name, near),
            (false, true) => too_far(&place.name, &evidence.frames[last], reading)
                .or_else(|| wrong_thing(&place.name, near, evidence.source)),
            // A name that may mean either, as "stairs".
            _ => None,
        }?;
        Some(finding(Check::Landmarks, verdict, reason, Some(reading.events[at].span)))
    };
    ends(reading).into_iter().flatten().filter(|(at, _)| object != Some(*at)).find_map(wrong)
}

/// The places that a text ends at: the first of the clause that stops, and the last that one is sent to, if one goes no
/// farther after it. Where a text stops, only a room counts as the latter.
fn ends(reading: &Reading) -> [Option<(usize, &Place)>; 2] {
    let events = &reading.events;
    let place = |at: usize| match &events[at].what {
        What::Place(place) => Some((at, place)),
        _ => None,
    };
    let stop = events.iter().rposition(|event| event.what == What::Stop);
    let at_stop = stop.and_then(|stop| {
        let clause = events[stop].clause;
        (stop + 1..events.len()).filter(|at| events[*at].clause == clause).find_map(place)
    });
    let goes_on = |event: &Event| match &event.what {
        What::Turn(_) | What::Climb(_) | What::Onward => true,
        What::Place(place) => place.going.is_some(),
        _ => false,
    };
    let sent_to = (0..events.len()).rev().filter_map(place).find(|(_, place)| place.link == Link::Goal);
    let sent_to = sent_to.filter(|(at, place)| {
        !events[at + 1..].iter().any(goes_on) && (stop.is_none() || place.is_room && !place.is_thing)
    });
    [at_stop, sent_to]
}

fn wrong_room(name: &str, near: &[FrameEvidence]) -> Option<(Verdict, String)> {
    let is_it = |room: &String| same_room(room, name);
    let last = near.last()?;
    // They are storeys, and their rooms have names of their own.
    if matches!(room_name(name), Some("basement" | "attic")) {
        return None;
    }
    if last.rooms.iter().any(is_it) {
        return None;
    }
    let is_known = !last.rooms.is_empty();
    let is_perhaps = near.iter().flat_map(|frame| frame.rooms.iter().chain(&frame.perhaps.rooms)).any(is_it);
    Some(match is_known && !is_perhaps {
        true => (Verdict::Fail, format!("the path does not end in {name:?}")),
        false => (Verdict::Unverified, format!("the program cannot check whether the path ends in {name:?}")),
    })
}

/// The thing at which a text stops, where the nearest of its name is known to be far from the end.
fn too_far(name: &str, last: &FrameEvidence, reading: &Reading) -> Option<(Verdict, String)> {
    let stops = reading.events.iter().any(|event| event.what == What::Stop);
    let class = thing(name).map_or(Class::Unknown, |thing| thing.class);
    // A wide thing is near though its centre is far.
    let is_wide = matches!(class, Class::Stairs | Class::Fabric | Class::Floor | Class::Unknown);
    let alike = last.things.iter().filter(|thing| agree(&thing.name, name));
    let far_m = alike.map(|thing| thing.distance_m.unwrap_or(0.0)).min_by(f64::total_cmp)?;
    let is_far = stops && !is_wide && far_m > NEAR_M;
    is_far.then(|| (Verdict::Fail, format!("the nearest {name:?} is {far_m:.1} m from where the path ends")))
}

fn wrong_thing(name: &str, near: &[FrameEvidence], source: Source) -> Option<(Verdict, String)> {
    let shows = |frame: &FrameEvidence| frame.things.iter().any(|thing| agree(&thing.name, name));
    if near.iter().any(shows) {
        return None;
    }
    let class = thing(name).map(|thing| thing.class);
    let is_listed = class.is_some_and(|class| !matches!(class, Class::Door | Class::Stairs)) && !is_fabric(name);
    let is_perhaps = near.iter().any(|frame| frame.may_show(name));
    let lists = |frame: &FrameEvidence| if source.leaves_out() { frame.lists_things } else { frame.knows_things };
    Some(match is_listed && !is_perhaps && near.iter().all(lists) {
        true => (Verdict::Fail, format!("{name:?} is not seen from the end of the path")),
        false => (Verdict::Unverified, format!("the program cannot check whether {name:?} is at the end of the path")),
    })
}

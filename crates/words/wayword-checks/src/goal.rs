//! Checks where a text ends: its last landmark has to be seen from the end and near it, and its last room has to be
//! the path's.

use super::new_finding;
use crate::{
    evidence::{Evidence, EvidenceSource, FrameEvidence, is_wide},
    memory::{frames_at_doors, is_door},
};
use wayword_core::{CheckFinding, CheckKind, Verdict};
use wayword_language::{
    lexicon::{ThingClass, find_thing, is_fabric, names_agree, room_name, same_room},
    reading::{EventContent, PlaceLink, PlaceMention, TextEvent, TextReading},
};

/// "Stop by the sofa" fails where the sofa's centre is farther than this from the eye at the end, metres. For things on
/// the floor that is 2 m along the floor.
pub(crate) const MAX_STOP_DISTANCE_M: f64 = 2.5;

/// How findings begin that could not decide the room at the end. A model that sees may be asked.
pub const UNDECIDED_END_ROOM: &str = "the program cannot check whether the path ends in";
/// How findings end that could not decide whether a thing is at the end. A model that sees may be asked.
pub const UNDECIDED_AT_END: &str = "is at the end of the path";

/// The mistake at the end of a text, if there is one. The event `object` is left out: it names the object of the
/// task, which has a check of its own.
pub(super) fn check_goal(reading: &TextReading, evidence: &Evidence, object: Option<usize>) -> Option<CheckFinding> {
    if evidence.source == EvidenceSource::Nothing {
        return None;
    }
    let last = evidence.frames.len().checked_sub(1)?;
    // Captions give no distances: a walker at the end may have passed the landmark by one step.
    let first = if evidence.source == EvidenceSource::Labels { last } else { last.saturating_sub(1) };
    let near = &evidence.frames[first..];
    // The last hop leads through a door, and not far beyond it.
    let ends_near = evidence.moves.last().is_some_and(|hop| hop.distance_m <= MAX_STOP_DISTANCE_M);
    let ends_at_door = |name: &str| ends_near && is_door(name) && frames_at_doors(evidence).contains(&last);
    let wrong = |(at, place): (usize, &PlaceMention)| {
        let (verdict, reason) = match (place.is_room, place.is_thing) {
            (true, false) if place.link != PlaceLink::Beside => wrong_room(&place.name, near),
            (false, true) => find_distant_stop(&place.name, &evidence.frames[last], reading)
                .or_else(|| wrong_thing(&place.name, near, evidence.source).filter(|_| !ends_at_door(&place.name))),
            // A name that may mean either, as "stairs".
            _ => None,
        }?;
        Some(new_finding(CheckKind::Landmarks, verdict, reason, Some(reading.events[at].span)))
    };
    end_places(reading).into_iter().flatten().filter(|(at, _)| object != Some(*at)).find_map(wrong)
}

/// The places that a text ends at: the first of the clause that stops, and the last that one is sent to, if one goes no
/// farther after it. Where a text has a stop, the second one counts only if it is a room.
fn end_places(reading: &TextReading) -> [Option<(usize, &PlaceMention)>; 2] {
    let events = &reading.events;
    let place = |at: usize| match &events[at].what {
        EventContent::Place(place) => Some((at, place)),
        _ => None,
    };
    let stop = events.iter().rposition(|event| event.what == EventContent::Stop);
    let after_stop = |stop: usize| (stop + 1..events.len()).filter(move |at| events[*at].clause == events[stop].clause);
    let in_stop = || stop.into_iter().flat_map(after_stop);
    let at_stop = in_stop().find_map(place);
    // "Wait in the bathroom" says itself that it is not in the room before it.
    let is_within = |(_, place): (usize, &PlaceMention)| is_room_alone(place) && place.link == PlaceLink::Within;
    let names_room = in_stop().filter_map(place).any(is_within);
    let goes_on = |event: &TextEvent| match &event.what {
        EventContent::Turn(_) | EventContent::Climb(_) | EventContent::Onward => true,
        EventContent::Place(place) => place.going.is_some(),
        _ => false,
    };
    let sent_to = (0..events.len()).rev().filter_map(place).find(|(_, place)| place.link == PlaceLink::Goal);
    let sent_to = sent_to.filter(|(at, place)| {
        !events[at + 1..].iter().any(goes_on) && (stop.is_none() || is_room_alone(place) && !names_room)
    });
    [at_stop, sent_to]
}

/// Whether a name means a room and no thing.
fn is_room_alone(place: &PlaceMention) -> bool {
    place.is_room && !place.is_thing
}

/// The mistake in the last room of a text. `near`: the frames at the end of the path.
fn wrong_room(name: &str, near: &[FrameEvidence]) -> Option<(Verdict, String)> {
    let is_it = |room: &String| same_room(room, name);
    let last = near.last()?;
    // A basement and an attic are storeys, and their rooms have names of their own.
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
        false => (Verdict::Unverified, format!("{UNDECIDED_END_ROOM} {name:?}")),
    })
}

/// The thing at which a text stops, where the nearest of its name is known to be far from the end.
fn find_distant_stop(name: &str, last: &FrameEvidence, reading: &TextReading) -> Option<(Verdict, String)> {
    let stops = reading.events.iter().any(|event| event.what == EventContent::Stop);
    let alike = last.things.iter().filter(|thing| names_agree(&thing.name, name));
    let far_m = alike.map(|thing| thing.distance_m.unwrap_or(0.0)).min_by(f64::total_cmp)?;
    let is_far = stops && !is_wide(name) && far_m > MAX_STOP_DISTANCE_M;
    is_far.then(|| (Verdict::Fail, format!("the nearest {name:?} is {far_m:.1} m from where the path ends")))
}

/// The mistake in the last thing of a text, which none of the frames at the end of the path (`near`) may show.
fn wrong_thing(name: &str, near: &[FrameEvidence], source: EvidenceSource) -> Option<(Verdict, String)> {
    let shows = |frame: &FrameEvidence| frame.things.iter().any(|thing| names_agree(&thing.name, name));
    if near.iter().any(shows) {
        return None;
    }
    let class = find_thing(name).map(|thing| thing.class);
    // Doors, stairs, fabrics and unknown things are often in sight without being listed.
    let is_listed =
        class.is_some_and(|class| !matches!(class, ThingClass::Door | ThingClass::Stairs)) && !is_fabric(name);
    let is_perhaps = near.iter().any(|frame| frame.may_show(name));
    let lists = |frame: &FrameEvidence| if source.leaves_out() { frame.lists_things } else { frame.knows_things };
    Some(match is_listed && !is_perhaps && near.iter().all(lists) {
        true => (Verdict::Fail, format!("{name:?} is not seen from the end of the path")),
        false => (Verdict::Unverified, format!("the program cannot check whether {name:?} {UNDECIDED_AT_END}")),
    })
}

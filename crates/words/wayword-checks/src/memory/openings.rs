//! Finds the places where a walk goes from one room to another, and whether there is a door.

use super::{RememberedThing, RoomStay, stays_and_bends, things::nearest_hops};
use crate::Evidence;
use std::collections::BTreeSet;
use wayword_core::DVec3;
use wayword_language::lexicon::{ThingClass, find_thing, room_name};

/// A change of rooms between two frames in a row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RoomOpening {
    /// The last frame before the opening.
    pub before: usize,
    /// The first frame behind the opening.
    pub behind: usize,
    /// The room that one leaves.
    pub from: String,
    /// The room that one enters.
    pub to: String,
    /// Whether there is a door or doorway in it.
    pub has_door: bool,
}

/// Rooms with a wall around them: one enters and leaves them through a door or doorway. Between the others a house may
/// be open.
const WALLED_ROOMS: &[&str] = &[
    "bedroom",
    "bathroom",
    "toilet",
    "closet",
    "office",
    "laundry room",
    "utility room",
    "garage",
    "meeting room",
    "classroom",
    "porch",
    "balcony",
    "outdoor area",
    "gym",
    "locker room",
    "spa",
    "tv room",
    "library",
];

/// Whether a change from one room to another leads through a door or doorway: one of them has walls of its own.
#[must_use]
pub fn leads_through_a_door(from: &str, to: &str) -> bool {
    let name = |room: &str| room_name(room).unwrap_or_default().to_owned();
    let (from, to) = (name(from), name(to));
    let is_closed = |room: &String| WALLED_ROOMS.contains(&room.as_str());
    let is_outside = |room: &String| matches!(room.as_str(), "porch" | "balcony" | "outdoor area");
    from != to && (is_closed(&from) || is_closed(&to)) && !(is_outside(&from) && is_outside(&to))
}

/// The openings between stays that follow one another without a frame between.
pub(super) fn find_openings(stays: &[RoomStay], evidence: &Evidence) -> Vec<RoomOpening> {
    let next = stays.windows(2).filter(|pair| pair[0].left + 1 == pair[1].entered);
    next.map(|pair| {
        let (before, behind) = (pair[0].left, pair[1].entered);
        RoomOpening {
            before,
            behind,
            has_door: leads_through_a_door(&pair[0].room, &pair[1].room)
                || [before, behind].iter().any(|frame| shows_door(evidence, *frame)),
            from: pair[0].room.clone(),
            to: pair[1].room.clone(),
        }
    })
    .collect()
}

/// The frames on either side of a door or doorway through which the walk leads.
pub(crate) fn frames_at_doors(evidence: &Evidence) -> Vec<usize> {
    let through =
        find_openings(&stays_and_bends::find_stays(evidence), evidence).into_iter().filter(|opening| opening.has_door);
    through.flat_map(|opening| [opening.before, opening.behind]).collect()
}

/// Whether a name means an opening between rooms. A change of rooms shows it, even if labels do not list it.
pub(crate) fn is_door(name: &str) -> bool {
    matches!(name, "door" | "doorway" | "opening" | "entrance" | "exit" | "threshold")
}

/// Whether the lexicon has a name among those of doors.
pub(crate) fn is_any_door(name: &str) -> bool {
    find_thing(name).is_some_and(|thing| thing.class == ThingClass::Door)
}

/// Whether a name means a door or another opening between rooms.
#[must_use]
pub fn is_way_through(name: &str) -> bool {
    is_door(name) || is_any_door(name)
}

/// The hops of a walk that lead through a thing of such a name, a door or doorway, where one hop alone does.
pub(super) fn hops_through(
    things: &[RememberedThing],
    eyes: &[DVec3],
    is_meant: impl Fn(&str) -> bool,
) -> BTreeSet<usize> {
    let doors = things.iter().filter(|thing| is_meant(&thing.name)).filter_map(|thing| thing.position);
    let hop = |door: DVec3| match nearest_hops(eyes, door)? {
        (hops, near_m) if near_m <= IN_DOOR_M && hops.len() == 1 => hops.first().copied(),
        _ => None,
    };
    doors.filter_map(hop).collect()
}

/// The hops of a walk from before a door through it. Whoever stands in the door when the hop begins is through it.
pub(super) fn hops_to_doors(things: &[RememberedThing], eyes: &[DVec3]) -> BTreeSet<usize> {
    let doors = || things.iter().filter(|thing| is_any_door(&thing.name)).filter_map(|thing| thing.position);
    let is_before = |hop: &usize| {
        let far_m = |door: DVec3| (door - eyes[*hop]).truncate().length();
        doors().map(far_m).fold(f64::INFINITY, f64::min) > STANDS_IN_DOOR_M
    };
    hops_through(things, eyes, is_any_door).into_iter().filter(is_before).collect()
}

/// Whether a door is seen from a frame, near where that is known.
fn shows_door(evidence: &Evidence, frame: usize) -> bool {
    let is_near = |distance_m: Option<f64>| distance_m.is_none_or(|distance_m| distance_m <= DOOR_M);
    let things = evidence.frames.get(frame).into_iter().flat_map(|frame| &frame.things);
    things.into_iter().any(|seen| is_any_door(&seen.name) && is_near(seen.distance_m))
}

/// A hop that comes so near to the middle of a door leads through it, metres.
pub(crate) const IN_DOOR_M: f64 = 0.5;

/// A walker so near to the middle of a door stands in it, metres.
const STANDS_IN_DOOR_M: f64 = 0.3;

/// A door whose position is known lies at most so far from one of the two frames between which it is, metres.
pub(super) const OPENING_DOOR_M: f64 = 1.4;

/// A door up to this far from one of the two frames is taken to be the one between them, metres.
const DOOR_M: f64 = 2.5;

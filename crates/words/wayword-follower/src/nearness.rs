//! Computes for each viewpoint of a building how near it is to a room or thing that a text names.

use crate::building_parts::{BuildingThing, BuildingViewpoint};
use std::collections::BTreeSet;
use wayword_core::DVec3;
use wayword_language::lexicon::{names_agree, room_name, same_room};

/// A place to search for: a room or a thing of a name.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct PlaceQuery {
    pub(crate) is_room: bool,
    pub(crate) name: String,
}

/// How near each viewpoint of a building is to the nearest room or object of a name.
#[derive(Debug)]
pub(crate) struct PlaceNearness {
    /// For each viewpoint, the class of its distance: 0 there, then farther and farther up to [`FAR_CLASS`]; [`UNKNOWN_CLASS`] where
    /// the walker was not.
    pub(crate) class: Vec<usize>,
    /// For each viewpoint, the position of the nearest such room or object.
    pub(crate) nearest: Vec<Option<DVec3>>,
    /// How many of the known viewpoints are near such a place: 0 few, 1 some (8 % and more), 2 many (25 % and more).
    pub(crate) commonness: usize,
    /// Whether the building has such a place.
    pub(crate) exists: bool,
}

/// The class of viewpoints that are far from the place.
pub(crate) const FAR_CLASS: usize = 5;
/// The class of viewpoints where the walker was not and the distance is unknown.
pub(crate) const UNKNOWN_CLASS: usize = 6;
/// Number of classes.
pub(crate) const CLASSES: usize = 7;

/// Distance that a storey between two places adds, metres.
const STOREY_M: f64 = 6.0;

impl PlaceNearness {
    /// The nearness of each viewpoint to the place that `what` describes.
    pub(crate) fn for_query(viewpoints: &[BuildingViewpoint], things: &[BuildingThing], what: &PlaceQuery) -> Self {
        match what.is_room {
            true => Self::for_room(viewpoints, &what.name),
            false => Self::for_thing(viewpoints, things, &what.name),
        }
    }

    fn for_thing(viewpoints: &[BuildingViewpoint], things: &[BuildingThing], name: &str) -> Self {
        let names: BTreeSet<&str> = things.iter().map(|thing| thing.name.as_str()).collect();
        let meant: BTreeSet<&str> = names.into_iter().filter(|other| names_agree(other, name)).collect();
        let things: Vec<&BuildingThing> = things.iter().filter(|thing| meant.contains(&*thing.name)).collect();
        let mut seen = vec![false; viewpoints.len()];
        for at in things.iter().flat_map(|thing| &thing.seen_from) {
            seen[*at] = true;
        }
        // Classes 0 and 1 see the thing; classes 2 to 4 are within 3, 5 and 8 m of it.
        let class = |at: usize, far_m: f64| match far_m {
            far_m if seen[at] && far_m < 1.3 => 0,
            _ if seen[at] => 1,
            far_m if far_m < 3.0 => 2,
            far_m if far_m < 5.0 => 3,
            far_m if far_m < 8.0 => 4,
            _ => FAR_CLASS,
        };
        let found: Vec<(usize, Option<DVec3>)> = (0..viewpoints.len())
            .map(|at| {
                let places = things.iter().map(|thing| (thing.position, thing.seen_from.contains(&at)));
                // The eye is above most things: only things well above it, or below its feet, are on another storey.
                let (far_m, place) = nearest_place(viewpoints[at].position, places, [-2.2, 1.0]);
                (class(at, far_m), place)
            })
            .collect();
        Self::from_classes(viewpoints, found, !things.is_empty(), 3)
    }

    fn for_room(viewpoints: &[BuildingViewpoint], name: &str) -> Self {
        let is_stairs = room_name(name) == Some("stairs");
        let room = |at: usize| viewpoints[at].room.as_deref();
        let is_exact = |at: usize| room(at).is_some_and(|room| room_name(room) == room_name(name));
        let is_same: Vec<bool> =
            (0..viewpoints.len()).map(|at| room(at).is_some_and(|room| same_room(room, name))).collect();
        let places = || (0..viewpoints.len()).filter(|at| is_same[*at]).map(|at| (viewpoints[at].position, false));
        let found: Vec<(usize, Option<DVec3>)> = (0..viewpoints.len())
            .map(|at| {
                let viewpoint = &viewpoints[at];
                let (far_m, place) = nearest_place(viewpoint.position, places(), [-1.5, 1.5]);
                // Classes 0 and 1 are in the room; classes 2 to 4 are within 2.2, 4 and 7 m of it.
                let class = match far_m {
                    _ if is_stairs && viewpoint.climbs.contains(&true) || is_exact(at) => 0,
                    _ if is_same[at] => 1,
                    far_m if far_m < 2.2 => 2,
                    far_m if far_m < 4.0 => 3,
                    far_m if far_m < 7.0 => 4,
                    _ => FAR_CLASS,
                };
                (class, place)
            })
            .collect();
        let exists = is_stairs || is_same.contains(&true);
        Self::from_classes(viewpoints, found, exists, 1)
    }

    /// Makes a nearness of the class and the nearest position for each viewpoint. Viewpoints where the walker was not have an
    /// unknown distance if their class would be `least` or more.
    fn from_classes(
        viewpoints: &[BuildingViewpoint],
        found: Vec<(usize, Option<DVec3>)>,
        exists: bool,
        least: usize,
    ) -> Self {
        let known = |(at, (class, _)): (usize, &(usize, Option<DVec3>))| match viewpoints[at].is_known {
            false if *class >= least => UNKNOWN_CLASS,
            _ => *class,
        };
        let class: Vec<usize> = found.iter().enumerate().map(known).collect();
        let known = class.iter().filter(|class| **class != UNKNOWN_CLASS).count();
        let share = class.iter().filter(|class| **class <= 2).count() as f64 / known.max(1) as f64;
        let commonness = usize::from(share >= 0.08) + usize::from(share >= 0.25);
        Self { class, nearest: found.into_iter().map(|(_, place)| place).collect(), commonness, exists }
    }
}

/// The distance over ground to the nearest of these places, metres, and its position. A place that is seen from here,
/// or at a height above `from` between the limits, is on this storey. Other places are farther by [`MIN_STOREY_HEIGHT_M`].
fn nearest_place(
    from: DVec3,
    places: impl Iterator<Item = (DVec3, bool)>,
    [low_m, high_m]: [f64; 2],
) -> (f64, Option<DVec3>) {
    let mut best = (f64::INFINITY, None);
    for (place, is_seen) in places {
        let off = place - from;
        let is_level = is_seen || (low_m..high_m).contains(&off.z);
        let far_m = libm::hypot(off.x, off.y) + if is_level { 0.0 } else { STOREY_M };
        if far_m < best.0 {
            best = (far_m, Some(place));
        }
    }
    best
}

#[cfg(test)]
mod tests;

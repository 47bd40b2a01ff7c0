//! Checks "on your left" in an open world, by every thing of that name that is listed near the path.
//!
//! Of people's true claims, one in three hundred has every listed thing on the other side; of flipped ones, one in a
//! hundred. That is far from enough to call a side wrong, so it is unverified.

use crate::{CheckSubject, evidence::PathSurroundings, sides};
use std::f64::consts::{PI, TAU};
use wayword_core::{DVec3, Side, Verdict};
use wayword_language::reading::PlaceMention;

/// Only things up to this far from the path can be those that a text means, metres.
const REACH_M: f64 = 6.0;
/// Only points of the path up to this far from a thing count for its side, metres.
const SIGHT_M: f64 = 9.0;
/// Each hop is divided into this many equal parts, and the sides are compared at the ends of the parts.
const POINTS_PER_HOP: usize = 5;
/// A direction is clearly on a side if it is at least this far from straight ahead and from straight behind, degrees.
const CLEAR_SIDE_DEG: f64 = 20.0;

/// The doubt about the side of a place: every thing of its name near the path is clearly on the other side all along
/// the path, or the motion is unknown.
pub(super) fn unclear_side(place: &PlaceMention, subject: CheckSubject<'_>) -> Option<(Verdict, String)> {
    let side = place.side?;
    let name = &place.name;
    if sides::is_side_unknown(place, subject.evidence) {
        let reason = format!("the program cannot check on which side of the walker {name:?} is");
        return Some((Verdict::Unverified, reason));
    }
    let sign = match side {
        Side::Left => -1.0,
        Side::Right => 1.0,
        Side::Ahead | Side::Behind => return None,
    };
    let turns = directions_to(name, place.is_room, subject.reach.surroundings?);
    let is_wrong = |deg: &f64| deg * sign <= -CLEAR_SIDE_DEG && deg.abs() <= 180.0 - CLEAR_SIDE_DEG;
    let all_wrong = !turns.is_empty() && turns.iter().all(is_wrong);
    let reason = || format!("every {name:?} that is listed near the path is on another side, which says little");
    all_wrong.then(|| (Verdict::Unverified, reason()))
}

/// The directions of all things of that name from points along the path, degrees from the way ahead, positive right.
fn directions_to(name: &str, is_room: bool, around: &PathSurroundings) -> Vec<f64> {
    let mut spots = around.thing_spots(name, REACH_M);
    if is_room {
        spots.extend(around.room_spots(name, REACH_M));
    }
    let mut turns = Vec::new();
    for hop in around.eyes().windows(2) {
        let ahead = heading_rad(hop[1] - hop[0]);
        for step in 0..=POINTS_PER_HOP {
            let eye = hop[0] + (hop[1] - hop[0]) * (step as f64 / POINTS_PER_HOP as f64);
            let near = spots.iter().filter(|spot| spot.distance(eye) <= SIGHT_M);
            turns.extend(near.map(|spot| wrap_rad(heading_rad(*spot - eye) - ahead).to_degrees()));
        }
    }
    turns
}

/// The heading of a vector over the floor, radians, clockwise from north.
fn heading_rad(to: DVec3) -> f64 {
    libm::atan2(to.x, to.y)
}

/// The same angle in [-π, π).
fn wrap_rad(rad: f64) -> f64 {
    (rad + PI).rem_euclid(TAU) - PI
}

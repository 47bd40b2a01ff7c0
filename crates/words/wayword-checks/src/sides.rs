//! Left and right for a walker on the path: whether a thing is on the side that a text gives it.

use crate::evidence::Evidence;
use std::f64::consts::{PI, TAU};
use wayword_core::Side;
use wayword_language::{lexicon::names_agree, reading::PlaceMention};

/// Whether a direction from the heading (radians, positive right) is on a side, as people use the word: roughly, and
/// not straight ahead.
pub(super) fn lies_on(side: Side, turn_rad: f64) -> bool {
    let deg = turn_rad.to_degrees();
    match side {
        Side::Right => (10.0..170.0).contains(&deg),
        Side::Left => (10.0..170.0).contains(&-deg),
        Side::Ahead => deg.abs() < 70.0,
        Side::Behind => deg.abs() > 110.0,
    }
}

/// The word for a side.
pub(super) fn side_word(side: Side) -> &'static str {
    match side {
        Side::Ahead => "front",
        Side::Right => "right",
        Side::Behind => "back",
        Side::Left => "left",
    }
}

/// The side that the text gives a place, where the place is on that side in none of the given frames.
pub(super) fn wrong_side(place: &PlaceMention, frames: &[usize], evidence: &Evidence) -> Option<Side> {
    let side = place.side?;
    let turns: Vec<f64> = frames.iter().flat_map(|at| turns_to(place, *at, evidence)).collect();
    (!turns.is_empty() && !turns.iter().any(|turn_rad| lies_on(side, *turn_rad))).then_some(side)
}

/// Whether the side of a place cannot be checked: without poses, a picture's left need not be the walker's.
pub(super) fn is_unknown(place: &PlaceMention, evidence: &Evidence) -> bool {
    place.side.is_some() && !evidence.motion.is_known()
}

/// The directions of a named thing at a frame, from the heading of arrival and from that of leaving.
fn turns_to(place: &PlaceMention, at: usize, evidence: &Evidence) -> Vec<f64> {
    let leaving_rad = evidence.moves.get(at).map_or(0.0, |step| step.turn_rad);
    let things = evidence.frames[at].things.iter().filter(|thing| names_agree(&thing.name, &place.name));
    let wrap = |rad: f64| (rad + PI).rem_euclid(TAU) - PI;
    things.filter_map(|thing| thing.turn_rad).flat_map(|turn_rad| [turn_rad, wrap(turn_rad - leaving_rad)]).collect()
}

//! Left and right for a walker on the path: whether a thing is on the side that a text gives it.

use crate::evidence::Evidence;
use std::f64::consts::{PI, TAU};
use wayword_core::Side;
use wayword_language::{lexicon::names_agree, reading::PlaceMention};

/// Whether a direction from the heading (radians, positive right) is on a side, as people use the word: roughly, and
/// not straight ahead. A direction can be on two sides.
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

/// The side that the text gives a place, if it is wrong: the place is on that side in none of the given frames. `None`
/// also where no frame has the place's direction.
pub(super) fn wrong_side(place: &PlaceMention, frames: &[usize], evidence: &Evidence) -> Option<Side> {
    let side = place.side?;
    let turns: Vec<f64> = frames.iter().flat_map(|at| turns_to(place, *at, evidence)).collect();
    (!turns.is_empty() && !turns.iter().any(|turn_rad| lies_on(side, *turn_rad))).then_some(side)
}

/// Whether the side of a place cannot be checked: without poses, a picture's left need not be the walker's.
pub(super) fn is_side_unknown(place: &PlaceMention, evidence: &Evidence) -> bool {
    place.side.is_some() && !evidence.motion.is_known()
}

/// The directions of a named thing at a frame, from the heading of arrival and from that of leaving.
fn turns_to(place: &PlaceMention, at: usize, evidence: &Evidence) -> Vec<f64> {
    let leaving_rad = evidence.moves.get(at).map_or(0.0, |step| step.turn_rad);
    let things = evidence.frames[at].things.iter().filter(|thing| names_agree(&thing.name, &place.name));
    things
        .filter_map(|thing| thing.turn_rad)
        .flat_map(|turn_rad| [turn_rad, wrap_angle(turn_rad - leaving_rad)])
        .collect()
}

/// An angle in [-π, π).
pub(super) fn wrap_angle(rad: f64) -> f64 {
    (rad + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        SeenThing,
        tests::{exact_rad, frame, on_video, walk},
    };
    use std::collections::BTreeSet;
    use wayword_language::reading::{EventContent, read_instruction};

    #[test]
    fn lies_on_has_these_limits() {
        let on = |side, deg: f64| lies_on(side, exact_rad(deg));
        for (side, deg, wanted) in [
            (Side::Right, 9.9, false),
            (Side::Right, 10.1, true),
            (Side::Right, 169.9, true),
            (Side::Right, 170.1, false),
            (Side::Right, -90.0, false),
            (Side::Left, -9.9, false),
            (Side::Left, -10.1, true),
            (Side::Left, -169.9, true),
            (Side::Left, -170.1, false),
            (Side::Left, 90.0, false),
            (Side::Ahead, 69.9, true),
            (Side::Ahead, 70.1, false),
            (Side::Ahead, -69.9, true),
            (Side::Ahead, -70.1, false),
            (Side::Behind, 110.1, true),
            (Side::Behind, 109.9, false),
            (Side::Behind, -110.1, true),
            (Side::Behind, -109.9, false),
            (Side::Behind, 180.0, true),
        ] {
            assert_eq!(on(side, deg), wanted, "{side:?} {deg}");
        }
    }

    #[test]
    fn side_words_are_those_of_people() {
        assert_eq!(Side::ALL.map(side_word), ["front", "right", "back", "left"]);
    }

    /// The place of a text.
    fn place(text: &str) -> PlaceMention {
        let events = read_instruction(text, &BTreeSet::new()).events;
        let mut places = events.into_iter().filter_map(|event| match event.what {
            EventContent::Place(place) => Some(place),
            _ => None,
        });
        places.next().unwrap()
    }

    /// Two frames with a sofa in this direction from the first, and a turn there.
    fn beside(turn_rad: Option<f64>, turn_deg: f64) -> Evidence {
        let mut path =
            walk(vec![frame("hallway", Some(&["rug"]), 1), frame("hallway", Some(&["lamp"]), 1)], &[(turn_deg, 0.0)]);
        path.frames[0].things.push(SeenThing { name: "sofa".into(), turn_rad, ..SeenThing::default() });
        path
    }

    #[test]
    fn wrong_side_is_one_that_fits_neither_on_arrival_nor_on_leaving() {
        let left = place("Pass the sofa on your left.");
        let wrong = |deg: f64, turn_deg: f64| wrong_side(&left, &[0], &beside(Some(deg.to_radians()), turn_deg));
        assert_eq!((wrong(-90.0, 0.0), wrong(90.0, 0.0)), (None, Some(Side::Left)));
        // After a turn to the right by 90 degrees, what was ahead is on the left, and what was at the right is ahead.
        assert_eq!((wrong(0.0, 90.0), wrong(90.0, 90.0)), (None, Some(Side::Left)));
        assert_eq!(wrong(0.0, -90.0), Some(Side::Left));
        // Directions go around in a circle: behind on the right is on the left after a turn to the left.
        assert_eq!((wrong(150.0, -90.0), wrong(-150.0, 90.0)), (None, None));
        assert_eq!(wrong(150.0, 0.0), Some(Side::Left));
    }

    #[test]
    fn wrong_side_needs_a_side_a_frame_and_a_direction() {
        let left = place("Pass the sofa on your left.");
        let right_of_walker = beside(Some(1.5), 0.0);
        assert_eq!(wrong_side(&left, &[0], &right_of_walker), Some(Side::Left));
        assert_eq!(wrong_side(&left, &[1], &right_of_walker), None, "the second frame shows no sofa");
        assert_eq!(wrong_side(&left, &[], &right_of_walker), None);
        assert_eq!(wrong_side(&left, &[0], &beside(None, 0.0)), None);
        assert_eq!(wrong_side(&place("Pass the sofa."), &[0], &right_of_walker), None);
    }

    #[test]
    fn a_side_is_unknown_only_without_poses() {
        let left = place("Pass the sofa on your left.");
        assert!(is_side_unknown(&left, &on_video()) && !is_side_unknown(&left, &beside(None, 0.0)));
        assert!(!is_side_unknown(&place("Pass the sofa."), &on_video()));
    }
}

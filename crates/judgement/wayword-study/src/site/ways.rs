//! Describes the ways on from a place, for the buttons of a walker. The script describes them again whenever the walker turns, by the
//! same rules: `nameWays` in `assets/script.js`.

use crate::study::{PageTexts, StudyScene, StudyViewpoint, fill_placeholders};
use serde::Serialize;
use std::{cmp::Ordering, collections::BTreeMap};
use wayword_core::{DVec3, Heading};

/// Slope, radians (20 degrees). A steeper way counts as stairs. A ramp is flatter.
const MIN_STAIRS_SLOPE_RAD: f64 = 0.35;
/// Height of the eye above the floor, metres: about that of all platforms.
const EYE_M: f64 = 1.5;
/// Two ways in one direction are told apart by their lengths if they differ by less than this, degrees.
const SAME_DIRECTION_DEG: f64 = 8.0;
/// A bend nearer than this has no spot, metres along the floor: it lies at the walker's feet, where no picture shows it.
const MIN_BEND_M: f64 = 0.8;

/// A way to a neighbouring viewpoint.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct OnwardWay {
    /// Its index among the neighbours. A viewpoint's name could reveal which place it is.
    pub(super) id: String,
    /// Its heading, degrees.
    pub(super) deg: f64,
    /// Where the picture marks it; `None` where the picture does not show its floor.
    pub(super) spot: Option<FloorSpot>,
    /// `up` or `down` on stairs; otherwise empty.
    pub(super) stairs: &'static str,
    /// Its direction in words, seen from the viewing direction. No two ways of a place have the same.
    pub(super) words: String,
    /// Its length in whole metres, at least 1.
    pub(super) metres: u32,
    /// Its length, metres.
    pub(super) length_m: f64,
}

/// A spot on the floor, as the walker sees it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct FloorSpot {
    /// Its heading, degrees.
    pub(super) deg: f64,
    /// The rise from the eye to it, metres for each metre along the floor; negative below the eye.
    pub(super) slope: f64,
}

impl FloorSpot {
    /// The spot at a point of the floor, given relative to the eye.
    fn at(off: DVec3, facing: Heading) -> Self {
        let heading = Heading::towards(DVec3::ZERO, off).unwrap_or(facing);
        let slope = off.z / libm::hypot(off.x, off.y).max(0.1);
        Self { deg: round_to_tenth(heading.deg()), slope: (slope * 1000.0).round() / 1000.0 }
    }
}

/// The ways on from a place for a walker who looks along `facing`, from left to right.
pub(super) fn ways_from_place(
    scene: &StudyScene,
    place: &StudyViewpoint,
    facing: Heading,
    texts: &PageTexts,
) -> Vec<OnwardWay> {
    let way = |(index, neighbour): (usize, &wayword_core::ViewpointId)| {
        let off = scene.places.get(neighbour)?.eye_position() - place.eye_position();
        let heading = Heading::towards(DVec3::ZERO, off).unwrap_or(facing);
        let flat_m = libm::hypot(off.x, off.y);
        let stairs = match libm::atan2(off.z, flat_m) {
            up if up > MIN_STAIRS_SLOPE_RAD => "up",
            down if down < -MIN_STAIRS_SLOPE_RAD => "down",
            _ => "",
        };
        let spot = match place.bends.get(neighbour) {
            None => Some(FloorSpot::at(off - DVec3::Z * EYE_M, facing)),
            Some(bend) => Some(DVec3::from_array(*bend) - place.eye_position())
                .filter(|off| libm::hypot(off.x, off.y) >= MIN_BEND_M)
                .map(|off| FloorSpot::at(off, facing)),
        };
        let length_m = off.length();
        let way = OnwardWay {
            id: index.to_string(),
            deg: round_to_tenth(heading.deg()),
            spot,
            stairs,
            words: String::new(),
            metres: (length_m.round() as u32).max(1),
            length_m: round_to_tenth(length_m),
        };
        Some((facing.turn_to(heading).to_degrees(), way))
    };
    let mut ways: Vec<(f64, OnwardWay)> = place.neighbours.iter().enumerate().filter_map(way).collect();
    ways.sort_by(|a, b| a.0.total_cmp(&b.0));
    let turns_deg: Vec<f64> = ways.iter().map(|(turn_deg, _)| *turn_deg).collect();
    let mut ways: Vec<OnwardWay> = ways.into_iter().map(|(_, way)| way).collect();
    name_ways(&mut ways, &turns_deg, texts);
    ways
}

fn round_to_tenth(number: f64) -> f64 {
    (number * 10.0).round() / 10.0
}

/// Gives each way its words. `turns_deg` are the turns to the ways, from left to right.
fn name_ways(ways: &mut [OnwardWay], turns_deg: &[f64], texts: &PageTexts) {
    let word = |key: &str| texts.text("walk", key);
    let mut groups: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (at, (way, turn_deg)) in ways.iter().zip(turns_deg).enumerate() {
        let direction = word(direction_key(*turn_deg)).to_owned();
        let words = match way.stairs {
            "" => direction,
            stairs => fill_placeholders(word(stairs), [("way", direction)]),
        };
        groups.entry(words).or_default().push(at);
    }
    for (words, group) in groups {
        let by_distance = match group[..] {
            [a, b] if (turns_deg[a] - turns_deg[b]).abs() < SAME_DIRECTION_DEG => {
                Some(ways[a].length_m.total_cmp(&ways[b].length_m)).filter(|order| *order != Ordering::Equal)
            }
            _ => None,
        };
        for (rank, at) in group.iter().enumerate() {
            let key = match (group.len(), by_distance) {
                (1, _) => {
                    ways[*at].words.clone_from(&words);
                    continue;
                }
                (_, Some(order)) if (order == Ordering::Less) == (rank == 0) => "near_one",
                (_, Some(_)) => "far_one",
                (2, None) => ["left_one", "right_one"][rank],
                (3, None) => ["left_one", "middle_one", "right_one"][rank],
                _ => "numbered_one",
            };
            let values = [("way", words.clone()), ("number", (rank + 1).to_string())];
            ways[*at].words = fill_placeholders(word(key), values);
        }
    }
}

/// The key of the words for a turn. It uses the bounds of the turn words in `core::motion`, and finer ones, because two neighbouring doors
/// need different words.
fn direction_key(turn_deg: f64) -> &'static str {
    match turn_deg.abs() {
        turn if turn < 15.0 => "ahead",
        turn if turn > 155.0 => "back",
        turn if turn < 60.0 => ["slightly_right", "slightly_left"][usize::from(turn_deg < 0.0)],
        turn if turn < 120.0 => ["right", "left"][usize::from(turn_deg < 0.0)],
        _ => ["back_right", "back_left"][usize::from(turn_deg < 0.0)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::{BTreeMap, BTreeSet};
    use wayword_core::{SceneId, ViewpointId};

    /// The ways from the origin to these positions, for a walker who faces north.
    fn ways_to(positions: &[[f64; 3]]) -> Vec<OnwardWay> {
        let id = |at: usize| ViewpointId::new(format!("v{at}")).unwrap();
        let place = |position: [f64; 3], neighbours: Vec<ViewpointId>| StudyViewpoint {
            position,
            level: None,
            neighbours,
            bends: BTreeMap::new(),
            panorama: String::new(),
        };
        let here = place([0.0; 3], (0..positions.len()).map(id).collect());
        let places: BTreeMap<_, _> =
            positions.iter().enumerate().map(|(at, position)| (id(at), place(*position, Vec::new()))).collect();
        let scene = StudyScene { scene: SceneId::new("s").unwrap(), places };
        ways_from_place(&scene, &here, Heading::NORTH, &PageTexts::default())
    }

    fn words(positions: &[[f64; 3]]) -> Vec<(String, String)> {
        ways_to(positions).into_iter().map(|way| (way.id, way.words)).collect()
    }

    fn told(expected: &[(&str, &str)]) -> Vec<(String, String)> {
        expected.iter().map(|(id, words)| ((*id).to_owned(), (*words).to_owned())).collect()
    }

    #[test]
    fn ways_go_from_left_to_right_and_name_stairs() {
        let positions = [[2.0, 0.0, 0.0], [-2.0, 0.0, 0.0], [0.0, 2.0, 1.5]];
        assert_eq!(words(&positions), told(&[("1", "to the left"), ("2", "ahead, up"), ("0", "to the right")]));
        let stairs = &ways_to(&positions)[1];
        assert_eq!(
            (stairs.metres, stairs.length_m, stairs.spot.map(|spot| spot.slope)),
            (3, 2.5, Some(0.0)),
            "its floor is as high as the eye"
        );
    }

    #[test]
    fn ways_in_one_direction_are_told_apart() {
        let two = [[0.3, 2.0, 0.0], [-0.3, 2.0, 0.0]];
        assert_eq!(words(&two), told(&[("1", "ahead, the one on the left"), ("0", "ahead, the one on the right")]));
        let behind_each_other = [[0.0, 3.0, 0.0], [0.1, 1.5, 0.0]];
        assert_eq!(words(&behind_each_other), told(&[("0", "ahead, the farther one"), ("1", "ahead, the nearer one")]));
        let four = [[1.0, 1.2, 0.0], [1.0, 0.9, 0.0], [1.0, 2.0, 0.0], [1.0, 1.5, 0.0]];
        let ordinals = [1, 2, 3, 4].map(|one| format!("slightly to the right, spot {one} from the left"));
        assert_eq!(words(&four).into_iter().map(|(_, words)| words).collect::<Vec<_>>(), ordinals);
    }

    #[test]
    fn a_short_way_is_a_metre_and_its_end_lies_at_the_feet() {
        let way = &ways_to(&[[0.0, 0.3, 0.0]])[0];
        assert_eq!((way.metres, way.spot), (1, Some(FloorSpot { deg: 0.0, slope: -5.0 })));
    }

    #[test]
    fn a_way_round_a_corner_is_marked_at_its_bend_and_not_on_the_wall() {
        let id = |name: &str| ViewpointId::new(name).unwrap();
        let place = |position: [f64; 3], bends: &[(&str, [f64; 3])]| StudyViewpoint {
            position,
            level: None,
            neighbours: vec![id("far"), id("feet")],
            bends: bends.iter().map(|(name, bend)| (id(name), *bend)).collect(),
            panorama: String::new(),
        };
        // One way bends two metres ahead, the other one at the walker's feet.
        let here = place([0.0, 0.0, 1.5], &[("far", [0.0, 2.0, 0.0]), ("feet", [0.0, 0.3, 0.0])]);
        let places =
            BTreeMap::from([(id("far"), place([2.0, 2.0, 1.5], &[])), (id("feet"), place([3.0, 0.0, 1.5], &[]))]);
        let scene = StudyScene { scene: SceneId::new("s").unwrap(), places };
        let ways = ways_from_place(&scene, &here, Heading::NORTH, &PageTexts::default());
        assert_eq!(ways[0].spot, Some(FloorSpot { deg: 0.0, slope: -0.75 }));
        assert_eq!((ways[0].deg, ways[1].spot), (45.0, None));
    }

    proptest! {
        #[test]
        fn no_two_ways_have_one_name(
            positions in prop::collection::vec(prop::array::uniform3(-3.0..3.0f64), 1..16),
        ) {
            let ways = ways_to(&positions);
            let names: BTreeSet<&str> = ways.iter().map(|way| way.words.as_str()).collect();
            prop_assert_eq!(names.len(), positions.len());
            prop_assert!(ways.iter().all(|way| way.metres >= 1 && way.spot.is_some_and(|spot| spot.slope.is_finite())));
        }
    }
}

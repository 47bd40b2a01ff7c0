//! Describes the ways on from a place, for the buttons of a walker.

use crate::study::{StudyScene, StudyViewpoint};
use serde::Serialize;
use wayword_core::Heading;

/// Slope, radians (20 degrees). A steeper way counts as stairs. A ramp is flatter.
const MIN_STAIRS_SLOPE_RAD: f64 = 0.35;

/// A way to a neighbouring viewpoint.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct OnwardWay {
    /// Its index among the neighbours. A viewpoint's name could reveal which place it is.
    pub(super) id: String,
    /// Its heading, degrees.
    pub(super) deg: f64,
    /// Its direction in words, seen from the viewing direction.
    pub(super) words: String,
    /// Its length, metres.
    pub(super) metres: f64,
}

/// The ways on from a place for a walker who looks along `facing`, from left to right.
pub(super) fn ways_from_place(scene: &StudyScene, place: &StudyViewpoint, facing: Heading) -> Vec<OnwardWay> {
    let way = |(index, neighbour): (usize, &wayword_core::ViewpointId)| {
        let there = scene.places.get(neighbour)?.eye_position();
        let heading = Heading::towards(place.eye_position(), there).unwrap_or(facing);
        let flat_m = libm::hypot(there.x - place.eye_position().x, there.y - place.eye_position().y);
        let slope_rad = libm::atan2(there.z - place.eye_position().z, flat_m);
        let turn_deg = facing.turn_to(heading).to_degrees();
        let stairs = match slope_rad {
            up if up > MIN_STAIRS_SLOPE_RAD => ", up",
            down if down < -MIN_STAIRS_SLOPE_RAD => ", down",
            _ => "",
        };
        let words = format!("{}{stairs}", describe_turn(turn_deg));
        let metres = place.eye_position().distance(there);
        Some((
            turn_deg,
            OnwardWay {
                id: index.to_string(),
                deg: round_to_tenth(heading.deg()),
                words,
                metres: round_to_tenth(metres),
            },
        ))
    };
    let mut ways: Vec<(f64, OnwardWay)> = place.neighbours.iter().enumerate().filter_map(way).collect();
    ways.sort_by(|a, b| a.0.total_cmp(&b.0));
    ways.into_iter().map(|(_, way)| way).collect()
}

fn round_to_tenth(number: f64) -> f64 {
    (number * 10.0).round() / 10.0
}

/// A turn in words. It uses the bounds of the turn words in `core::motion`, and finer ones, because two neighbouring doors need
/// different words.
fn describe_turn(turn_deg: f64) -> &'static str {
    match turn_deg.abs() {
        turn if turn < 15.0 => "ahead",
        turn if turn > 155.0 => "back",
        turn if turn < 60.0 => ["slightly to the right", "slightly to the left"][usize::from(turn_deg < 0.0)],
        turn if turn < 120.0 => ["to the right", "to the left"][usize::from(turn_deg < 0.0)],
        _ => ["back, to the right", "back, to the left"][usize::from(turn_deg < 0.0)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use wayword_core::{SceneId, ViewpointId};

    #[test]
    fn ways_go_from_left_to_right_and_name_stairs() {
        let id = |name: &str| ViewpointId::new(name).unwrap();
        let place = |position: [f64; 3], neighbours: &[&str]| StudyViewpoint {
            position,
            level: None,
            neighbours: neighbours.iter().map(|name| id(name)).collect(),
            panorama: String::new(),
        };
        let places = BTreeMap::from([
            (id("here"), place([0.0; 3], &["east", "west", "stairs"])),
            (id("east"), place([2.0, 0.0, 0.0], &[])),
            (id("west"), place([-2.0, 0.0, 0.0], &[])),
            (id("stairs"), place([0.0, 2.0, 1.5], &[])),
        ]);
        let scene = StudyScene { scene: SceneId::new("s").unwrap(), places };
        let found = ways_from_place(&scene, &scene.places[&id("here")], Heading::NORTH);
        let told: Vec<(&str, &str)> = found.iter().map(|way| (way.id.as_str(), way.words.as_str())).collect();
        assert_eq!(told, [("1", "to the left"), ("2", "ahead, up"), ("0", "to the right")]);
        assert_eq!(found[1].metres, 2.5);
    }
}

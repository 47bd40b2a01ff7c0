//! Small buildings, texts and feature lists for the tests, made by hand.

use crate::{
    building::KnownBuilding,
    building_parts::{BuildingThing, BuildingViewpoint},
    features::{
        FeatureNumber,
        tables::{self, FeatureTable},
    },
    guide::{Guide, GuideMention, GuideStep, GuideStepKind},
    nearness::PlaceQuery,
    weights::FeatureWeights,
};
use rand::Rng;
use wayword_core::{DVec3, seeded_rng};
use wayword_language::reading::steps::{InstructionStep, StepDoor, StepRelation, StepStairs};

/// A building of viewpoints (east, north, up, room; "" is no room) with ways that lead in both directions.
pub(crate) fn make_building(places: &[(f64, f64, f64, &str)], ways: &[(usize, usize)]) -> KnownBuilding {
    let mut building = KnownBuilding::default();
    for (at, (east, north, up, room)) in places.iter().enumerate() {
        let ahead = ways.iter().filter(|(from, _)| *from == at).map(|(_, to)| *to);
        let back = ways.iter().filter(|(_, to)| *to == at).map(|(from, _)| *from);
        building.viewpoints.push(BuildingViewpoint {
            position: DVec3::new(*east, *north, *up),
            neighbours: ahead.chain(back).collect(),
            room: (!room.is_empty()).then(|| (*room).to_owned()),
            level: None,
            is_known: true,
            climbs: [false; 2],
        });
    }
    building.find_stairs();
    building
}

/// A straight corridor to the north: viewpoints every 2 m, one room for each name.
pub(crate) fn make_corridor(rooms: &[&str]) -> KnownBuilding {
    let places: Vec<_> = rooms.iter().enumerate().map(|(at, room)| (0.0, 2.0 * at as f64, 1.5, *room)).collect();
    let ways: Vec<_> = (1..rooms.len()).map(|at| (at - 1, at)).collect();
    make_building(&places, &ways)
}

/// Puts a thing into a building.
pub(crate) fn add_thing(building: &mut KnownBuilding, name: &str, [east, north, up]: [f64; 3], seen_from: &[usize]) {
    let position = DVec3::new(east, north, up);
    building.things.push(BuildingThing { name: name.to_owned(), position, seen_from: seen_from.to_vec() });
}

/// A step of a kind without any content.
pub(crate) fn bare_step(kind: GuideStepKind) -> GuideStep {
    let step = InstructionStep {
        span: [0, 0],
        turn: None,
        turn_span: None,
        is_slight: false,
        climb: None,
        floor: None,
        storey: None,
        stops: false,
        is_straight: false,
        is_condition: false,
        at_end: false,
        door: StepDoor::None,
        stairs: StepStairs::None,
        is_outdoors: false,
        side: None,
        places: Vec::new(),
        marks: Vec::new(),
    };
    GuideStep { step, kind, mentions: Vec::new() }
}

/// A guide of these steps that names no room.
pub(crate) fn make_guide(steps: Vec<GuideStep>) -> Guide {
    let mut guide = Guide::read_text("");
    guide.steps = steps;
    guide
}

/// A mention of a place.
pub(crate) fn make_mention(relation: StepRelation, is_room: bool, name: &str) -> GuideMention {
    let meanings = vec![PlaceQuery { is_room, name: name.to_owned() }];
    GuideMention { span: None, relation, side: None, tells_turn: false, meanings }
}

/// The features of one table, each as its place in every dimension of the given sizes.
pub(crate) fn places_in<const N: usize>(
    found: &[FeatureNumber],
    table: &FeatureTable,
    sizes: [usize; N],
) -> Vec<[usize; N]> {
    let within = found.iter().map(|feature| *feature as usize);
    within
        .filter(|feature| (table.from..table.from + table.size).contains(feature))
        .map(|feature| {
            let mut rest = feature - table.from;
            let mut places = [0; N];
            for at in (0..N).rev() {
                places[at] = rest % sizes[at];
                rest /= sizes[at];
            }
            places
        })
        .collect()
}

/// Weights without any pattern.
pub(crate) fn random_weights(seed: u64) -> FeatureWeights {
    let mut random = seeded_rng(seed, &["weights"]);
    FeatureWeights::from_values(&(0..tables::COUNT).map(|_| random.random_range(-1.0..1.0)).collect::<Vec<_>>())
}

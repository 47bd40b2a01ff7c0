//! Weights written by hand. They are a start for a fit, and the measure of what a fit adds.

use super::Weights;
use crate::{
    features::tables::{
        ANGLES, CROSSINGS, GROUPS, HOPS, HOPS_CLASSES, LAST_ROOM, LAST_THING, NAMED_ROOM, NAMED_THING, OPENING_TURN,
        RELATIONS, RISE, ROOM, SIDE_OF_PLACE, SIDE_OF_TURN, THING, TURN_AFTER_OPENING, TURN_AT, Table, WHOLE_TURN,
        WIDEST_TURN,
    },
    guide::Kind,
    near::CLASSES,
};
use wayword_language::reading::steps::Relation;

/// How a step of each kind goes with 0, 1, 2 ... hops.
const OF_HOPS: [[f64; HOPS_CLASSES]; Kind::COUNT] = [
    [-2.4, 0.0, -1.6, -3.5, -5.6, -8.0, -9.6, -11.2],
    [-1.6, 0.0, -1.6, -3.5, -5.6, -8.0, -9.6, -11.2],
    [-1.1, 0.0, -2.4, -4.8, -6.4, -8.0, -9.6, -11.2],
    [-6.4, -0.8, 0.0, 0.0, -0.5, -1.6, -3.2, -4.8],
    [0.0, -1.1, -4.0, -6.4, -8.0, -9.6, -11.2, -12.8],
    [0.0, -0.5, -1.9, -4.0, -5.6, -7.2, -8.8, -10.4],
    [-1.6, 0.0, -0.3, -1.3, -2.6, -4.0, -5.6, -7.2],
    [-1.9, 0.0, -0.3, -1.6, -3.2, -4.8, -6.4, -8.0],
    [-1.6, 0.0, -0.3, -0.8, -1.9, -3.2, -4.8, -6.4],
    [0.0, -1.3, -2.9, -4.5, -6.1, -8.0, -9.6, -11.2],
];
/// How a climb goes with what the stretch gains, from 3 m against it to 3 m along it.
const OF_RISE: [f64; 11] = [-4.0, -4.0, -4.0, -3.5, -3.0, -2.0, 0.5, 1.5, 2.0, 2.5, 2.5];
/// How any other step goes with a rise or fall.
const OF_FLAT: [f64; 11] = [0.0, 0.0, 0.0, 0.0, 0.0, 0.3, -0.2, -0.7, -1.2, -1.5, -2.0];
/// How a mention goes with an object that is so near, and with a room.
const OF_THING: [f64; CLASSES] = [1.0, 0.8, 0.3, -0.4, -1.0, -1.5, 0.0];
const OF_ROOM: [f64; CLASSES] = [1.5, 1.0, 0.2, -0.7, -1.5, -2.0, 0.0];

pub(super) fn weights() -> Weights {
    let mut weights = Weights::none();
    let mut set = |table: &Table, places: &[(usize, usize)], value: f64| {
        let place = places.iter().fold(0, |place, (at, size)| place * size + at);
        weights.0[table.from + place] = value;
    };
    for (kind, row) in OF_HOPS.iter().enumerate() {
        for (hops, value) in row.iter().enumerate() {
            for is_last in 0..2 {
                set(&HOPS, &[(kind, Kind::COUNT), (is_last, 2), (hops, HOPS_CLASSES)], *value);
            }
        }
    }
    for (class, (told, flat)) in OF_RISE.iter().zip(OF_FLAT).enumerate() {
        set(&RISE, &[(0, 2), (class, 11)], *told);
        set(&RISE, &[(1, 2), (class, 11)], flat);
    }
    for (kind, at) in (0..Kind::COUNT).flat_map(|kind| (0..ANGLES).map(move |at| (kind, at))) {
        let deg = -180.0 + 15.0 * at as f64 + 7.5;
        let place = [(kind, Kind::COUNT), (at, ANGLES)];
        let goes = of_turn(kind, deg);
        let (opening, after) = if kind <= 2 { (0.6 * goes, 0.4 * goes) } else { (0.0, goes) };
        set(&WHOLE_TURN, &place, goes);
        set(&OPENING_TURN, &place, opening);
        set(&TURN_AFTER_OPENING, &place, after);
        if kind <= 1 {
            set(&WIDEST_TURN, &place, 0.3 * goes);
        }
    }
    for at in 0..12 {
        let goes = libm::sin((-180.0 + 30.0 * at as f64 + 15.0f64).to_radians());
        // The place lies on a side of the walker: positive right, and mirrored so that right is told.
        set(&SIDE_OF_PLACE, &[(at, 12)], 0.5 * goes);
        set(&SIDE_OF_TURN, &[(0, 4), (at, 12)], 0.5 * goes);
    }
    for relation in Relation::ALL {
        places(relation, &mut set);
    }
    for class in 0..CLASSES {
        set(&TURN_AT, &[(0, 2), (class, CLASSES)], 0.4 * OF_THING[class]);
        set(&TURN_AT, &[(1, 2), (class, CLASSES)], 0.4 * OF_ROOM[class]);
        set(&NAMED_ROOM, &[(class, CLASSES)], 0.5 * OF_ROOM[class]);
        // The last room and the last thing that a step leads to, or that it is in or at, are where the walk ends.
        for group in [1, 2] {
            set(&LAST_ROOM, &[(group, GROUPS), (class, CLASSES)], 0.8 * OF_ROOM[class]);
            set(&LAST_THING, &[(group, GROUPS), (class, CLASSES)], 0.6 * OF_THING[class]);
        }
        for commonness in 0..3 {
            set(&NAMED_THING, &[(commonness, 3), (class, CLASSES)], 0.5 * OF_THING[class]);
        }
    }
    for (crossings, value) in [-0.5, 0.3, 0.2, 0.0].into_iter().enumerate() {
        set(&CROSSINGS, &[(1, 4), (crossings, 4)], value);
        set(&CROSSINGS, &[(3, 4), (crossings, 4)], value);
    }
    weights
}

/// How a step of a kind goes with a turn of its stretch, degrees; positive is the side that the text tells.
fn of_turn(kind: usize, deg: f64) -> f64 {
    let around = |middle: f64, width: f64| 3.0 * (-((deg - middle) / width).powi(2)).exp() - 2.0;
    match kind {
        0 => around(85.0, 50.0),
        1 => around(45.0, 45.0),
        2 => around(180.0, 60.0),
        _ => 0.3 - 0.5 * (deg.abs() / 60.0).min(2.0),
    }
}

fn places(relation: Relation, set: &mut impl FnMut(&Table, &[(usize, usize)], f64)) {
    // Where along the stretch the place has to be: where it begins (0), anywhere (1), where it ends (2).
    let (at, of_room) = match relation {
        Relation::OutOf => (0, 1.0),
        Relation::Into | Relation::In => (2, 1.2),
        Relation::Through => (1, 1.0),
        Relation::Past | Relation::Between => (1, 0.5),
        Relation::To | Relation::At | Relation::Near | Relation::Before => (2, 0.6),
        Relation::Along => (1, 0.8),
        Relation::Plain | Relation::With | Relation::Of => (1, 0.4),
    };
    let relation = (relation as usize, RELATIONS);
    for class in 0..CLASSES {
        set(&ROOM, &[relation, (at, 3), (class, CLASSES)], of_room * OF_ROOM[class]);
        for (commonness, strength) in [0.8, 0.6, 0.3].into_iter().enumerate() {
            let place = [relation, (commonness, 3), (at, 3), (class, CLASSES)];
            set(&THING, &place, strength * OF_THING[class]);
        }
    }
}

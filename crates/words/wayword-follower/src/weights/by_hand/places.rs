//! Weights by hand for the rooms and objects that a step names.

use super::{WeightSetter, middle_deg};
use crate::{
    features::tables::{
        AHEAD, GROUPS, LAST_ROOM, LAST_THING, NAMED_ROOM, NAMED_THING, NEAREST, RELATIONS, ROOM, ROOM_MOVE,
        SIDE_OF_PLACE, THING, TOWARDS, TURN_AT, UNNAMED_END, UNNAMED_PASSED,
    },
    nearness::CLASSES,
};
use wayword_language::reading::steps::StepRelation;

/// Weights of a mentioned object by the class of its distance, the nearest first; the last class is unknown.
const THING_WEIGHTS: [f64; CLASSES] = [1.0, 0.8, 0.3, -0.4, -1.0, -1.5, 0.0];
/// Weights of a mentioned room by the class of its distance, the nearest first; the last class is unknown.
const ROOM_WEIGHTS: [f64; CLASSES] = [1.5, 1.0, 0.2, -0.7, -1.5, -2.0, 0.0];

/// Sets the weights of rooms and objects.
pub(super) fn set_places(set: &mut WeightSetter<'_>) {
    for relation in StepRelation::ALL {
        set_nearness(relation, set);
        set_direction(relation, set);
    }
    for class in 0..CLASSES {
        set(&TURN_AT, &[(0, 2), (class, CLASSES)], 0.4 * THING_WEIGHTS[class]);
        set(&TURN_AT, &[(1, 2), (class, CLASSES)], 0.4 * ROOM_WEIGHTS[class]);
        for is_goal in 0..2 {
            set_walk_ends(class, is_goal, set);
        }
    }
    for at in 0..12 {
        // The place lies on the side in the text: positive right, mirrored if the text has left.
        set(&SIDE_OF_PLACE, &[(at, 12)], 0.6 * libm::sin(middle_deg(at, 12).to_radians()));
    }
    for passed in 0..5 {
        set(&UNNAMED_PASSED, &[(0, 2), (passed, 5)], -0.1 * passed as f64);
    }
    for (is_goal, commonness) in (0..2).flat_map(|is_goal| (0..3).map(move |commonness| (is_goal, commonness))) {
        set(&UNNAMED_END, &[(is_goal, 2), (1, 2), (commonness, 3)], 0.5);
    }
    // A step that leads to a place, or is at it, ends where the place is nearest.
    for (group, is_room, is_last) in [(1, 0, 0), (1, 0, 1), (2, 0, 0), (2, 0, 1)] {
        for which in 0..4 {
            let (was_nearer, comes_nearer) = (which & 2 != 0, which & 1 != 0);
            let weight = if was_nearer { -0.6 } else { 0.0 } - if comes_nearer { 0.5 } else { 0.0 };
            set(&NEAREST, &[(group, GROUPS), (is_room, 2), (is_last, 2), (which, 4)], weight);
        }
    }
}

/// Weights of the whole walk by its distance from the named places.
fn set_walk_ends(class: usize, is_goal: usize, set: &mut WeightSetter<'_>) {
    let (is_goal, class) = ((is_goal, 2), (class, CLASSES));
    set(&NAMED_ROOM, &[is_goal, class], 0.5 * ROOM_WEIGHTS[class.0]);
    for commonness in 0..3 {
        set(&NAMED_THING, &[is_goal, (commonness, 3), class], 0.5 * THING_WEIGHTS[class.0]);
    }
    // The last room and the last thing that a step leads to, or that it is in or at, are where the walk ends.
    for group in [1, 2] {
        set(&LAST_ROOM, &[is_goal, (group, GROUPS), class], 0.8 * ROOM_WEIGHTS[class.0]);
        set(&LAST_THING, &[is_goal, (group, GROUPS), class], 0.6 * THING_WEIGHTS[class.0]);
    }
}

/// Weights of the distance from a place along a stretch.
fn set_nearness(relation: StepRelation, set: &mut WeightSetter<'_>) {
    // Where along the stretch the place has to be: where it begins (0), anywhere (1), where it ends (2).
    let (at, room_strength) = match relation {
        StepRelation::OutOf => (0, 1.0),
        StepRelation::Into | StepRelation::In => (2, 1.2),
        StepRelation::Through => (1, 1.0),
        StepRelation::Past | StepRelation::Between => (1, 0.5),
        StepRelation::To | StepRelation::At | StepRelation::Near | StepRelation::Before => (2, 0.6),
        StepRelation::Along => (1, 0.8),
        StepRelation::Plain | StepRelation::With | StepRelation::Of => (1, 0.4),
    };
    let number = (relation as usize, RELATIONS);
    for class in 0..CLASSES {
        set(&ROOM, &[number, (at, 3), (class, CLASSES)], room_strength * ROOM_WEIGHTS[class]);
        for (commonness, strength) in [0.8, 0.6, 0.3].into_iter().enumerate() {
            let place = [number, (commonness, 3), (at, 3), (class, CLASSES)];
            set(&THING, &place, strength * THING_WEIGHTS[class]);
        }
    }
    // By whether the stretch begins in the room (2) and ends in it (1).
    let moves = match relation {
        StepRelation::OutOf => [-0.5, -1.0, 1.0, -0.5],
        StepRelation::Into => [-0.5, 1.0, -1.0, 0.0],
        _ => return,
    };
    for (which, weight) in moves.into_iter().enumerate() {
        set(&ROOM_MOVE, &[number, (which, 4)], weight);
    }
}

/// Whether the stretch leads to the place, and past it.
fn set_direction(relation: StepRelation, set: &mut WeightSetter<'_>) {
    let number = (relation as usize, RELATIONS);
    let towards = match relation {
        StepRelation::To | StepRelation::Into | StepRelation::Past | StepRelation::Through => [0.5, 0.2, -0.3, -0.8],
        StepRelation::OutOf => [-0.3, 0.0, 0.1, 0.2],
        _ => [0.2, 0.1, -0.1, -0.3],
    };
    let ahead = match relation {
        StepRelation::Past | StepRelation::OutOf => [-0.6, -0.2, 0.3, 0.5],
        StepRelation::To | StepRelation::Before => [0.4, 0.1, -0.3, -0.5],
        _ => [0.0; 4],
    };
    for (is_room, angle) in (0..2).flat_map(|is_room| (0..4).map(move |angle| (is_room, angle))) {
        set(&TOWARDS, &[number, (is_room, 2), (angle, 4)], towards[angle]);
        for near in 0..3 {
            set(&AHEAD, &[number, (is_room, 2), (near, 3), (angle, 4)], ahead[angle]);
        }
    }
}

//! Weights written by hand from the meaning of the words, as smooth rules. They are the baseline that shows how much a
//! fit adds.

mod places;

use super::FeatureWeights;
use crate::{
    features::tables::{
        ANGLES, BORDER, CONDITION, CROSSINGS, FIRST_TURN, FeatureTable, HOPS, HOPS_CLASSES, HOPS_OF_STEPS, LATER_TURNS,
        LENGTH, LEVEL, LEVEL_RISE, LEVELS, ONWARD, OPENING_TURN, RISE, SAME_ROOM, SIDE_OF_TURN, SKIPPED, SQUARER,
        STAIRS_AT, STOPS, TURN_AFTER_OPENING, TURN_BEFORE, TURNS_TOLD, UNTOLD_HOPS, WALK_HOPS, WHOLE_TURN, WIDEST_TURN,
    },
    guide::GuideStepKind,
};

/// Sets a weight of a table, by its places in each dimension.
type WeightSetter<'a> = dyn FnMut(&FeatureTable, &[(usize, usize)], f64) + 'a;

/// For each kind of step: the weight of zero hops, the number of hops without a loss, and the loss for each further hop.
const HOP_WEIGHTS: [(f64, usize, f64); GuideStepKind::COUNT] = [
    (-2.5, 1, 1.0), // Turn
    (-2.0, 1, 1.0), // SlightTurn
    (-1.0, 1, 1.2), // TurnAround
    (-2.5, 3, 0.5), // Climb
    (0.0, 1, 1.2),  // Stop
    (-0.5, 1, 0.9), // Condition
    (-1.5, 2, 0.6), // Straight
    (-1.5, 2, 0.7), // Cross
    (-1.0, 2, 0.6), // Go
    (0.0, 1, 0.8),  // Other
    (-2.0, 6, 0.0), // Goal
    (0.0, 0, 0.7),  // Task
];
/// Weights of a described climb by the rise of the stretch, from 3 m against it to 3 m along it.
const CLIMB_RISE_WEIGHTS: [f64; 11] = [-4.0, -4.0, -4.0, -3.5, -3.0, -2.0, 0.5, 1.5, 2.0, 2.5, 2.5];
/// Weights of any other step by the rise of the stretch.
const OTHER_RISE_WEIGHTS: [f64; 11] = [0.0, 0.0, 0.0, 0.0, 0.0, 0.3, -0.3, -0.8, -1.2, -1.5, -2.0];

/// The weights of all tables; those that no rule sets are 0.
pub(super) fn weights_by_hand() -> FeatureWeights {
    let mut weights = FeatureWeights::all_zero();
    let mut set = |table: &FeatureTable, places: &[(usize, usize)], value: f64| {
        let place = places.iter().fold(0, |place, (at, size)| place * size + at);
        weights.0[table.from + place] = value;
    };
    set_lengths(&mut set);
    set_turns(&mut set);
    set_ways(&mut set);
    set_storeys(&mut set);
    places::set_places(&mut set);
    weights
}

/// Weights of the lengths of stretches and walks.
fn set_lengths(set: &mut WeightSetter<'_>) {
    for (kind, (none, free, loss)) in HOP_WEIGHTS.into_iter().enumerate() {
        for hops in 0..HOPS_CLASSES {
            let weight = if hops == 0 { none } else { -loss * hops.saturating_sub(free) as f64 };
            for is_last in 0..2 {
                set(&HOPS, &[(kind, GuideStepKind::COUNT), (is_last, 2), (hops, HOPS_CLASSES)], weight);
            }
        }
    }
    for hops in 0..HOPS_CLASSES {
        // A step that ends the walk comes after most of the way.
        let far = -0.2 * hops as f64;
        for (is_last, turns) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            set(&STOPS, &[(is_last, 2), (turns, 2), (hops, HOPS_CLASSES)], far);
        }
        set(&CONDITION, &[(0, 2), (hops, HOPS_CLASSES)], far);
    }
    for (kind, hops) in (0..GuideStepKind::COUNT).flat_map(|kind| (0..HOPS_CLASSES).map(move |hops| (kind, hops))) {
        // The fewer steps a text has, the farther each of them leads.
        for (steps, each) in [1.0, 0.0, -0.6].into_iter().enumerate() {
            for is_last in 0..2 {
                let place = [(steps, 3), (kind, GuideStepKind::COUNT), (is_last, 2), (hops, HOPS_CLASSES)];
                set(&HOPS_OF_STEPS, &place, each * hops as f64);
            }
        }
    }
    for (kind, class) in (0..GuideStepKind::COUNT).flat_map(|kind| (0..8).map(move |class| (kind, class))) {
        let length_m = [0.0, 1.0, 2.3, 4.0, 6.0, 8.5, 12.0, 16.0f64][class];
        let free_m = if kind == GuideStepKind::Goal as usize { 16.0 } else { 4.0 };
        set(&LENGTH, &[(kind, GuideStepKind::COUNT), (class, 8)], -0.2 * (length_m - free_m).max(0.0));
    }
    for hops in 0..WALK_HOPS {
        // Instructions describe walks of some length: without any step, the middle of the usual lengths is likeliest.
        set(&UNTOLD_HOPS, &[(hops, WALK_HOPS)], -0.3 * (hops as f64 - 5.0).abs());
    }
}

/// The weight of a turn by `deg` degrees for a step of a kind; positive angles are to the side in the text. The numbers are those
/// of [`GuideStepKind`].
fn turn_weight(kind: usize, deg: f64) -> f64 {
    let near = |middle: f64, width: f64, elsewhere: f64| {
        let off = (deg - middle).abs();
        let off = off.min(360.0 - off);
        (elsewhere + (-(off / width).powi(2)).exp()).ln()
    };
    match kind {
        // A turn, a slight turn, a turn around, a step straight on.
        0 => near(85.0, 50.0, 0.03) + 1.5,
        1 => near(45.0, 40.0, 0.05) + 1.2,
        2 => near(180.0, 70.0, 0.05) + 1.2,
        6 => near(0.0, 45.0, 0.08),
        // A text that describes no way allows any turn.
        10 => 0.0,
        _ => near(0.0, 55.0, 0.2),
    }
}

/// Weights of the turns of stretches and walks. Kinds 0 to 2 describe turns.
fn set_turns(set: &mut WeightSetter<'_>) {
    for (kind, at) in (0..GuideStepKind::COUNT).flat_map(|kind| (0..ANGLES).map(move |at| (kind, at))) {
        let weight = turn_weight(kind, middle_deg(at, ANGLES));
        let place = [(kind, GuideStepKind::COUNT), (at, ANGLES)];
        let is_turn = kind <= 2;
        // Texts leave out in which direction the walker looks first, so a turn in the first step may be the opening
        // turn or the next.
        set(&OPENING_TURN, &place, if is_turn { 0.6 * weight } else { 0.1 * weight });
        set(&TURN_AFTER_OPENING, &place, if is_turn { 0.3 * weight } else { 0.7 * weight });
        set(&FIRST_TURN, &place, 0.3 * weight);
        set(&WHOLE_TURN, &place, 0.7 * weight);
        set(&WIDEST_TURN, &place, 0.1 * weight);
    }
    for (kind, at) in (0..3).flat_map(|kind| (0..ANGLES).map(move |at| (kind, at))) {
        // The hop that turns belongs to the step before, or to this one.
        let deg = middle_deg(at, ANGLES);
        let weight = (turn_weight(kind, deg).exp() + 2.0 * turn_weight(6, deg).exp()).ln() - 1.0;
        for opens in 0..2 {
            set(&TURN_BEFORE, &[(kind, 3), (opens, 2), (at, ANGLES)], weight);
        }
    }
    for kind in 0..GuideStepKind::COUNT {
        for later in 1..3 {
            let loss = if kind == GuideStepKind::Goal as usize { 0.0 } else { 0.2 };
            set(&LATER_TURNS, &[(kind, GuideStepKind::COUNT), (later, 3)], -loss * later as f64);
        }
    }
    for (described, real) in (0..6).flat_map(|described| (0..7).map(move |real| (described, real))) {
        let surplus = real as f64 - described as f64;
        set(&TURNS_TOLD, &[(described, 7), (real, 7)], if surplus > 0.0 { -0.2 * surplus } else { 0.2 * surplus });
    }
    for at in 0..12 {
        // The way bends to the side in the text.
        let weight = libm::sin(middle_deg(at, 12).to_radians());
        for (group, strength) in [0.8, 0.4, 0.0, 0.3].into_iter().enumerate() {
            set(&SIDE_OF_TURN, &[(group, 4), (at, 12)], strength * weight);
        }
    }
}

/// The middle of a class of angles, degrees.
fn middle_deg(at: usize, classes: usize) -> f64 {
    360.0 * (at as f64 + 0.5) / classes as f64 - 180.0
}

/// Weights of the ways that a walk does not take: an obvious way is taken unless the text describes another.
fn set_ways(set: &mut WeightSetter<'_>) {
    for kind in 0..GuideStepKind::COUNT {
        let is_turn = kind <= 2;
        for count in 1..3 {
            if is_turn {
                set(&SQUARER, &[(kind, GuideStepKind::COUNT), (count, 3)], -0.3 * count as f64);
            }
            // Ways to the side of the next turn that it passes were not meant.
            for here in 0..3 {
                set(&SKIPPED, &[(kind, GuideStepKind::COUNT), (count, 3), (here, 3)], -0.4 * count as f64);
            }
        }
        set(&SKIPPED, &[(kind, GuideStepKind::COUNT), (0, 3), (1, 3)], 0.2);
        // "To the end of the hallway": no way weight straight on from there.
        set(&ONWARD, &[(kind, GuideStepKind::COUNT), (1, 2), (0, 2)], 0.5);
    }
    // Number of changes of room, for steps that do not mention doors, lead from one room to another, name a door, and
    // lead through it.
    let door_rows = [[0.1, -0.2, -0.5, -0.8], [-0.4, 0.3, 0.0, -0.3], [0.0, 0.0, -0.2, -0.4], [-0.4, 0.3, 0.1, -0.2]];
    for (door, row) in door_rows.into_iter().enumerate() {
        for (crossings, weight) in row.into_iter().enumerate() {
            set(&CROSSINGS, &[(door, 4), (crossings, 4)], weight);
        }
        // A walker who stops at a door, or behind one, has another room next to it.
        let beside = if door == 0 { -0.1 } else { 0.2 };
        for (border, sign) in [-1.0, 1.0, 1.0].into_iter().enumerate() {
            set(&BORDER, &[(door, 4), (1, 2), (border, 3)], sign * beside);
        }
    }
    set(&SAME_ROOM, &[(GuideStepKind::Stop as usize, GuideStepKind::COUNT), (1, 2)], 0.3);
    set(&SAME_ROOM, &[(GuideStepKind::Cross as usize, GuideStepKind::COUNT), (0, 2)], 0.3);
}

/// Weights of climbs, stairs and storeys.
fn set_storeys(set: &mut WeightSetter<'_>) {
    for (class, (climb, flat)) in CLIMB_RISE_WEIGHTS.iter().zip(OTHER_RISE_WEIGHTS).enumerate() {
        set(&RISE, &[(0, 2), (class, 11)], *climb);
        set(&RISE, &[(1, 2), (class, 11)], flat);
    }
    // Where a step ends at the top of stairs, ways down begin there, and not up.
    for (part, climbs) in [(1, 0), (1, 1), (2, 0), (2, 1)] {
        for ways in 0..4 {
            let (up, down) = (ways & 2 != 0, ways & 1 != 0);
            let (wanted, other) = if part == 1 { (down, up) } else { (up, down) };
            let weight = if wanted { 0.8 } else { -0.8 } - if other { 0.4 } else { 0.0 };
            set(&STAIRS_AT, &[(part, 3), (climbs, 2), (1, 2), (ways, 4)], weight);
        }
    }
    for (named, level, most) in
        (0..4).flat_map(|named| (0..4).flat_map(move |level| (0..3).map(move |most| (named, level, most))))
    {
        // Class 3 is the top storey or one above the third.
        let is_there = if named == 3 { level >= most } else { level == named };
        set(&LEVEL, &[(named, LEVELS), (level, 4), (most, 3)], if is_there { 1.0 } else { -1.0 });
    }
    for rise in 0..7 {
        let up = (rise as f64 - 3.0) / 1.5;
        set(&LEVEL_RISE, &[(4, LEVELS), (rise, 7)], up.clamp(-1.5, 1.5));
        set(&LEVEL_RISE, &[(5, LEVELS), (rise, 7)], (-up).clamp(-1.5, 1.5));
    }
}

#[cfg(test)]
mod tests;

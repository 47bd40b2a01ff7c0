use super::*;
use crate::features::tables::{
    AHEAD, GROUPS, LAST_ROOM, LAST_THING, NAMED_ROOM, NAMED_THING, NEAREST, RELATIONS, ROOM, ROOM_MOVE, SIDE_OF_PLACE,
    THING, TOWARDS, TURN_AT, UNNAMED_END, UNNAMED_PASSED,
};
use wayword_language::reading::steps::StepRelation;

const KINDS: usize = 12;

fn assert_near(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-9, "{a} {b}");
}

/// A weight by hand.
fn weight<const N: usize>(table: &FeatureTable, places: [(usize, usize); N]) -> f64 {
    weights_by_hand().values()[table.feature_at(places) as usize]
}

#[test]
fn turn_weight_is_highest_at_the_usual_angle() {
    let e1 = (-1.0f64).exp();
    for (kind, deg, expected) in [
        (0, 85.0, 1.03f64.ln() + 1.5),
        (0, 135.0, (0.03 + e1).ln() + 1.5),
        (0, 35.0, (0.03 + e1).ln() + 1.5),
        (0, -95.0, (0.03 + (-(180.0f64 / 50.0).powi(2)).exp()).ln() + 1.5),
        (0, -170.0, (0.03 + (-(105.0f64 / 50.0).powi(2)).exp()).ln() + 1.5),
        (1, 45.0, 1.05f64.ln() + 1.2),
        (1, 85.0, (0.05 + e1).ln() + 1.2),
        (2, 110.0, (0.05 + e1).ln() + 1.2),
        (2, -110.0, (0.05 + e1).ln() + 1.2),
        (2, 180.0, 1.05f64.ln() + 1.2),
        (6, 0.0, 1.08f64.ln()),
        (6, 45.0, (0.08 + e1).ln()),
        (10, 123.0, 0.0),
        (3, -55.0, (0.2 + e1).ln()),
        (11, 0.0, 1.2f64.ln()),
    ] {
        assert_near(turn_weight(kind, deg), expected);
    }
}

#[test]
fn middle_deg_is_the_middle_of_a_class() {
    for (at, classes, expected) in [(0, 24, -172.5), (12, 24, 7.5), (23, 24, 172.5), (0, 12, -165.0), (8, 12, 75.0)] {
        assert_near(middle_deg(at, classes), expected);
    }
}

#[test]
fn set_lengths_take_more_for_more_hops() {
    let hops = |kind, last, hops| weight(&HOPS, [(kind, KINDS), (last, 2), (hops, 8)]);
    for last in [0, 1] {
        // A turn is free for one hop and costs 1 for each further one.
        for (count, expected) in [(0, -2.5), (1, 0.0), (2, -1.0), (4, -3.0), (7, -6.0)] {
            assert_near(hops(0, last, count), expected);
        }
        assert_near(hops(3, last, 3), 0.0);
        assert_near(hops(3, last, 5), -1.0);
        assert_near(hops(11, last, 2), -1.4);
        assert_near(hops(10, last, 7), 0.0);
        assert_near(hops(10, last, 0), -2.0);
        for turn in [0, 1] {
            assert_near(weight(&STOPS, [(last, 2), (turn, 2), (5, 8)]), -1.0);
        }
        for (steps, expected) in [(0, 3.0), (1, 0.0), (2, -1.8)] {
            assert_near(weight(&HOPS_OF_STEPS, [(steps, 3), (4, KINDS), (last, 2), (3, 8)]), expected);
        }
    }
    assert_near(weight(&CONDITION, [(0, 2), (3, 8)]), -0.6);
    assert_near(weight(&CONDITION, [(1, 2), (3, 8)]), 0.0);
    let length = |kind, class| weight(&LENGTH, [(kind, KINDS), (class, 8)]);
    for (class, expected) in [(0, 0.0), (3, 0.0), (4, -0.4), (5, -0.9), (6, -1.6), (7, -2.4)] {
        assert_near(length(0, class), expected);
        assert_near(length(10, class), 0.0);
    }
    for (hops, expected) in [(0, -1.5), (5, 0.0), (7, -0.6), (11, -1.8)] {
        assert_near(weight(&UNTOLD_HOPS, [(hops, WALK_HOPS)]), expected);
    }
}

#[test]
fn set_turns_share_a_turn_between_the_tables() {
    for (kind, [opening, after]) in [(0, [0.6, 0.3]), (2, [0.6, 0.3]), (3, [0.1, 0.7]), (6, [0.1, 0.7])] {
        for at in [0, 5, 17, 23] {
            let goes = turn_weight(kind, 15.0 * at as f64 - 172.5);
            let place = [(kind, KINDS), (at, ANGLES)];
            assert_near(weight(&OPENING_TURN, place), opening * goes);
            assert_near(weight(&TURN_AFTER_OPENING, place), after * goes);
            assert_near(weight(&FIRST_TURN, place), 0.3 * goes);
            assert_near(weight(&WHOLE_TURN, place), 0.7 * goes);
            assert_near(weight(&WIDEST_TURN, place), 0.1 * goes);
        }
    }
    for (kind, opens) in [(0, 0), (1, 1), (2, 0)] {
        let deg = 15.0 * 4.0 + 7.5;
        let expected = (turn_weight(kind, deg).exp() + 2.0 * turn_weight(6, deg).exp()).ln() - 1.0;
        assert_near(weight(&TURN_BEFORE, [(kind, 3), (opens, 2), (16, ANGLES)]), expected);
    }
    for (kind, later, expected) in [(0, 0, 0.0), (0, 1, -0.2), (0, 2, -0.4), (10, 2, 0.0), (11, 2, -0.4)] {
        assert_near(weight(&LATER_TURNS, [(kind, KINDS), (later, 3)]), expected);
    }
    for (told, real, expected) in [(2, 2, 0.0), (1, 4, -0.6), (5, 1, -0.8), (6, 0, 0.0), (0, 6, -1.2)] {
        assert_near(weight(&TURNS_TOLD, [(told, 7), (real, 7)]), expected);
    }
    for (group, strength) in [(0, 0.8), (1, 0.4), (2, 0.0), (3, 0.3)] {
        assert_near(weight(&SIDE_OF_TURN, [(group, 4), (8, 12)]), strength * 75.0f64.to_radians().sin());
        assert_near(weight(&SIDE_OF_TURN, [(group, 4), (3, 12)]), strength * (-75.0f64).to_radians().sin());
    }
}

#[test]
fn set_ways_prefer_the_obvious_way() {
    for (kind, count, expected) in [(0, 1, -0.3), (2, 2, -0.6), (2, 0, 0.0), (3, 2, 0.0)] {
        assert_near(weight(&SQUARER, [(kind, KINDS), (count, 3)]), expected);
    }
    for kind in 0..KINDS {
        for (count, here, expected) in [(0, 0, 0.0), (0, 1, 0.2), (0, 2, 0.0), (1, 0, -0.4), (2, 1, -0.8), (2, 2, -0.8)]
        {
            assert_near(weight(&SKIPPED, [(kind, KINDS), (count, 3), (here, 3)]), expected);
        }
        assert_near(weight(&ONWARD, [(kind, KINDS), (1, 2), (0, 2)]), 0.5);
        assert_near(weight(&ONWARD, [(kind, KINDS), (1, 2), (1, 2)]), 0.0);
    }
    assert_near(weight(&CROSSINGS, [(0, 4), (3, 4)]), -0.8);
    assert_near(weight(&CROSSINGS, [(3, 4), (1, 4)]), 0.3);
    for (door, border, expected) in [(0, 0, 0.1), (0, 1, -0.1), (0, 2, -0.1), (2, 0, -0.2), (3, 2, 0.2)] {
        assert_near(weight(&BORDER, [(door, 4), (1, 2), (border, 3)]), expected);
        assert_near(weight(&BORDER, [(door, 4), (0, 2), (border, 3)]), 0.0);
    }
    for (kind, same, expected) in [(4, 1, 0.3), (4, 0, 0.0), (7, 0, 0.3), (7, 1, 0.0)] {
        assert_near(weight(&SAME_ROOM, [(kind, KINDS), (same, 2)]), expected);
    }
}

#[test]
fn set_storeys_follow_the_rise_and_the_level() {
    for (told, class, expected) in [(0, 0, -4.0), (0, 5, -2.0), (0, 10, 2.5), (1, 0, 0.0), (1, 5, 0.3), (1, 10, -2.0)] {
        assert_near(weight(&RISE, [(told, 2), (class, 11)]), expected);
    }
    for climbs in [0, 1] {
        // Ways up are 2, ways down 1. At the top only a way down is right, at the bottom only a way up.
        for (part, ways, expected) in
            [(1, 0, -0.8), (1, 1, 0.8), (1, 2, -1.2), (1, 3, 0.8 - 0.4), (2, 0, -0.8), (2, 1, -1.2), (2, 2, 0.8)]
        {
            assert_near(weight(&STAIRS_AT, [(part, 3), (climbs, 2), (1, 2), (ways, 4)]), expected);
        }
        assert_near(weight(&STAIRS_AT, [(1, 3), (climbs, 2), (0, 2), (1, 4)]), 0.0);
        assert_near(weight(&STAIRS_AT, [(0, 3), (climbs, 2), (1, 2), (1, 4)]), 0.0);
    }
    for (told, level, most, expected) in [
        (0, 0, 2, 1.0),
        (0, 1, 2, -1.0),
        (2, 2, 2, 1.0),
        (3, 0, 1, -1.0),
        (3, 1, 1, 1.0),
        (3, 3, 2, 1.0),
        (4, 0, 0, 0.0),
    ] {
        assert_near(weight(&LEVEL, [(told, LEVELS), (level, 4), (most, 3)]), expected);
    }
    for (told, rise, expected) in
        [(4, 0, -1.5), (4, 2, -2.0 / 3.0), (4, 3, 0.0), (4, 6, 1.5), (5, 0, 1.5), (5, 4, -2.0 / 3.0)]
    {
        assert_near(weight(&LEVEL_RISE, [(told, LEVELS), (rise, 7)]), expected);
    }
}

#[test]
fn set_places_prefer_walks_by_the_named_places() {
    for (class, thing, room) in [(0, 1.0, 1.5), (3, -0.4, -0.7), (6, 0.0, 0.0)] {
        let class = (class, 7);
        assert_near(weight(&TURN_AT, [(0, 2), class]), 0.4 * thing);
        assert_near(weight(&TURN_AT, [(1, 2), class]), 0.4 * room);
        for goal in [(0, 2), (1, 2)] {
            assert_near(weight(&NAMED_ROOM, [goal, class]), 0.5 * room);
            for commonness in 0..3 {
                assert_near(weight(&NAMED_THING, [goal, (commonness, 3), class]), 0.5 * thing);
            }
            for (group, is_end) in [(0, 0.0), (1, 1.0), (2, 1.0), (3, 0.0)] {
                assert_near(weight(&LAST_ROOM, [goal, (group, GROUPS), class]), is_end * 0.8 * room);
                assert_near(weight(&LAST_THING, [goal, (group, GROUPS), class]), is_end * 0.6 * thing);
            }
        }
    }
    assert_near(weight(&SIDE_OF_PLACE, [(8, 12)]), 0.6 * 75.0f64.to_radians().sin());
    assert_near(weight(&SIDE_OF_PLACE, [(2, 12)]), 0.6 * (-105.0f64).to_radians().sin());
    assert_near(weight(&UNNAMED_PASSED, [(0, 2), (4, 5)]), -0.4);
    assert_near(weight(&UNNAMED_PASSED, [(1, 2), (4, 5)]), 0.0);
    for (goal, commonness) in [(0, 0), (1, 2)] {
        assert_near(weight(&UNNAMED_END, [(goal, 2), (1, 2), (commonness, 3)]), 0.5);
        assert_near(weight(&UNNAMED_END, [(goal, 2), (0, 2), (commonness, 3)]), 0.0);
    }
    for (group, last) in [(1, 0), (1, 1), (2, 0), (2, 1)] {
        for (which, expected) in [(0, 0.0), (1, -0.5), (2, -0.6), (3, -1.1)] {
            assert_near(weight(&NEAREST, [(group, GROUPS), (0, 2), (last, 2), (which, 4)]), expected);
            assert_near(weight(&NEAREST, [(group, GROUPS), (1, 2), (last, 2), (which, 4)]), 0.0);
        }
    }
}

#[test]
fn set_places_know_where_along_a_stretch_a_place_has_to_be() {
    use StepRelation::{Along, At, Before, Between, In, Into, Near, Of, OutOf, Past, Plain, Through, To, With};
    let begin_anywhere_end: [(&[StepRelation], usize, f64); 7] = [
        (&[OutOf], 0, 1.0),
        (&[Into, In], 2, 1.2),
        (&[Through], 1, 1.0),
        (&[Past, Between], 1, 0.5),
        (&[To, At, Near, Before], 2, 0.6),
        (&[Along], 1, 0.8),
        (&[Plain, With, Of], 1, 0.4),
    ];
    for (relations, at, of_room) in begin_anywhere_end {
        for relation in relations {
            let number = (*relation as usize, RELATIONS);
            for other in 0..3 {
                let is_at = f64::from(u8::from(other == at));
                assert_near(weight(&ROOM, [number, (other, 3), (0, 7)]), is_at * of_room * 1.5);
                for (commonness, strength) in [(0, 0.8), (1, 0.6), (2, 0.3)] {
                    let place = [number, (commonness, 3), (other, 3), (4, 7)];
                    assert_near(weight(&THING, place), -(is_at * strength));
                }
            }
            let moves = match relation {
                OutOf => [-0.5, -1.0, 1.0, -0.5],
                Into => [-0.5, 1.0, -1.0, 0.0],
                _ => [0.0; 4],
            };
            let towards = match relation {
                To | Into | Past | Through => [0.5, 0.2, -0.3, -0.8],
                OutOf => [-0.3, 0.0, 0.1, 0.2],
                _ => [0.2, 0.1, -0.1, -0.3],
            };
            let ahead = match relation {
                Past | OutOf => [-0.6, -0.2, 0.3, 0.5],
                To | Before => [0.4, 0.1, -0.3, -0.5],
                _ => [0.0; 4],
            };
            for at in 0..4 {
                assert_near(weight(&ROOM_MOVE, [number, (at, 4)]), moves[at]);
                for is_room in [(0, 2), (1, 2)] {
                    assert_near(weight(&TOWARDS, [number, is_room, (at, 4)]), towards[at]);
                    assert_near(weight(&AHEAD, [number, is_room, (2, 3), (at, 4)]), ahead[at]);
                }
            }
        }
    }
}

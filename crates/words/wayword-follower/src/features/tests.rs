use super::{
    WalkStretch, angle_class, angle_twelfth, ending_features, limit_class, stretch_features,
    tables::{self, FeatureTable, relation_group},
};
use crate::{
    building::KnownBuilding,
    guide::{Guide, GuideMention, GuideStep, GuideStepKind, GuideTrial, LocatedMention},
    made_buildings::{bare_step, make_building, make_corridor, make_guide, make_mention, places_in},
    nearness::PlaceNearness,
    tree::WalkTree,
};
use std::sync::Arc;
use wayword_core::{ClimbDirection, DVec3, Side};
use wayword_language::reading::{
    StoreyMention,
    steps::{StepDoor, StepRelation, StepStairs},
};

const KINDS: usize = 12;

/// A corridor of nine viewpoints, 2 m apart, and its walk from end to end. Node and viewpoint have the same number.
fn corridor() -> (KnownBuilding, WalkTree) {
    let building = make_corridor(&["hallway"; 9]);
    let walk: Vec<usize> = (0..9).collect();
    let tree = WalkTree::single_walk(&building, &walk, 0.0);
    (building, tree)
}

/// The features of a step of a guide over the stretch of some hops that ends at a node.
fn found_in(trial: &GuideTrial<'_>, step: usize, tree: &WalkTree, end: usize, hops: usize) -> Vec<u32> {
    let mut found = Vec::new();
    stretch_features(trial, step, &WalkStretch::to_node(tree, end, hops), &mut found);
    found
}

fn changed(kind: GuideStepKind, change: impl FnOnce(&mut GuideStep)) -> GuideStep {
    let mut step = bare_step(kind);
    change(&mut step);
    step
}

fn turning(kind: GuideStepKind, side: Side) -> GuideStep {
    changed(kind, |told| told.step.turn = Some(side))
}

/// The places in one table for a guide of one step.
fn single<const N: usize>(
    building: &KnownBuilding,
    tree: &WalkTree,
    told: GuideStep,
    (end, hops): (usize, usize),
    (table, sizes): (&FeatureTable, [usize; N]),
) -> Vec<[usize; N]> {
    let guide = make_guide(vec![told]);
    places_in(&found_in(&GuideTrial::new(&guide, building), 0, tree, end, hops), table, sizes)
}

#[test]
fn angle_class_counts_steps_of_15_degrees_from_straight_back() {
    let class = |deg: f64| angle_class(deg.to_radians());
    assert_eq!([0.0, 14.0, 16.0, -1.0, 89.0, 91.0, -91.0].map(class), [12, 12, 13, 11, 17, 18, 5]);
    assert_eq!([-180.0, -166.0, -164.0, 179.0, 181.0].map(class), [0, 0, 1, 23, 0]);
}

#[test]
fn angle_twelfth_counts_steps_of_30_degrees() {
    let twelfth = |deg: f64| angle_twelfth(deg.to_radians());
    assert_eq!([-179.0, -91.0, -1.0, 1.0, 29.0, 31.0, 179.0].map(twelfth), [0, 2, 5, 6, 6, 7, 11]);
}

#[test]
fn limit_class_counts_the_limits_that_are_reached() {
    assert_eq!([0.9, 1.0, 1.1, 2.0, 2.5].map(|value| limit_class(value, &[1.0, 2.0])), [0, 1, 1, 2, 2]);
}

#[test]
fn feature_at_counts_the_last_dimension_fastest() {
    let table = FeatureTable { name: "made", from: 100, size: 24, is_fine: false };
    assert_eq!(table.feature_at([(0, 2), (0, 3), (0, 4)]), 100);
    assert_eq!(table.feature_at([(0, 2), (0, 3), (3, 4)]), 103);
    assert_eq!(table.feature_at([(1, 2), (2, 3), (3, 4)]), 100 + 12 + 8 + 3);
}

#[test]
fn relation_group_puts_alike_relations_together() {
    use StepRelation::{Along, At, Before, Between, In, Into, Near, Of, OutOf, Past, Plain, Through, To, With};
    let groups =
        [&[OutOf][..], &[Into, To], &[In, At, Near, Before], &[Through, Past, Along, Between], &[With, Of], &[Plain]];
    for (number, group) in groups.iter().enumerate() {
        assert!(group.iter().all(|relation| relation_group(*relation) == number), "{group:?}");
    }
}

#[test]
fn walk_stretch_lists_the_nodes_back_from_its_end() {
    let (_, tree) = corridor();
    let stretch = WalkStretch::to_node(&tree, 6, 3);
    assert_eq!((stretch.nodes(), stretch.first_node(), stretch.last_node()), (&[3, 4, 5, 6][..], 3, 6));
    let whole = WalkStretch::to_node(&tree, 8, 8);
    assert_eq!(whole.nodes(), [0, 1, 2, 3, 4, 5, 6, 7, 8]);
    let nothing = WalkStretch::to_node(&tree, 0, 0);
    assert_eq!((nothing.nodes(), nothing.first_node(), nothing.last_node()), (&[0][..], 0, 0));
}

#[test]
fn stretch_features_count_hops_and_metres() {
    let (building, tree) = corridor();
    // 0, 2, 4 ... 16 m, with limits at 0.1, 1.5, 3, 5, 7, 10 and 14 m.
    let lengths = [0, 2, 3, 4, 5, 6, 6, 7, 7];
    for (hops, length) in lengths.into_iter().enumerate() {
        let step = || {
            changed(GuideStepKind::Straight, |told| {
                told.step.stops = true;
                told.step.is_condition = true;
            })
        };
        let guide = make_guide(vec![step(), step()]);
        let trial = GuideTrial::new(&guide, &building);
        for at in [0, 1] {
            let found = found_in(&trial, at, &tree, 8, hops);
            let class = hops.min(7);
            assert_eq!(places_in(&found, &tables::HOPS, [KINDS, 2, 8]), [[6, at, class]]);
            assert_eq!(places_in(&found, &tables::STOPS, [2, 2, 8]), [[at, 0, class]]);
            assert_eq!(places_in(&found, &tables::CONDITION, [2, 8]), [[at, class]]);
            assert_eq!(places_in(&found, &tables::LENGTH, [KINDS, 8]), [[6, length]]);
        }
    }
    let told = changed(GuideStepKind::Turn, |told| {
        told.step.stops = true;
        told.step.turn = Some(Side::Left);
    });
    assert_eq!(single(&building, &tree, told, (4, 2), (&tables::STOPS, [2, 2, 8])), [[1, 1, 2]]);
    let plain = || bare_step(GuideStepKind::Go);
    assert!(single(&building, &tree, plain(), (4, 2), (&tables::STOPS, [2, 2, 8])).is_empty());
    assert!(single(&building, &tree, plain(), (4, 2), (&tables::CONDITION, [2, 8])).is_empty());
}

#[test]
fn stretch_features_depend_on_the_number_of_steps_and_mentions_and_on_the_next_step() {
    let (building, tree) = corridor();
    for (count, class) in [(1, 0), (2, 0), (3, 1), (4, 1), (5, 2), (6, 2)] {
        let mut steps = vec![bare_step(GuideStepKind::Go); count];
        steps.iter_mut().for_each(|told| told.mentions = vec![make_mention(StepRelation::To, true, "attic"); count]);
        steps[count - 1].kind = GuideStepKind::Stop;
        let guide = make_guide(steps);
        let trial = GuideTrial::new(&guide, &building);
        let last = found_in(&trial, count - 1, &tree, 8, 8);
        assert_eq!(places_in(&last, &tables::HOPS_OF_STEPS, [3, KINDS, 2, 8]), [[class, 4, 1, 7]]);
        assert_eq!(places_in(&last, &tables::HOPS_OF_MENTIONS, [KINDS, 2, 4, 5]), [[4, 1, count.min(3), 4]]);
        assert!(places_in(&last, &tables::NEXT_STEP, [KINDS, KINDS, 5]).is_empty());
        if count > 1 {
            let before = found_in(&trial, count - 2, &tree, 8, 3);
            assert_eq!(places_in(&before, &tables::HOPS_OF_STEPS, [3, KINDS, 2, 8]), [[class, 8, 0, 3]]);
            assert_eq!(places_in(&before, &tables::NEXT_STEP, [KINDS, KINDS, 5]), [[8, 4, 3]]);
            assert_eq!(places_in(&before, &tables::HOPS_OF_MENTIONS, [KINDS, 2, 4, 5]), [[8, 0, count.min(3), 3]]);
        }
    }
}

#[test]
fn stretch_features_give_the_first_bend_to_a_turn_in_the_step_before() {
    let (building, mut tree) = corridor();
    tree.nodes[1].turn_rad = 40.0f64.to_radians();
    tree.nodes[2].turn_rad = -70.0f64.to_radians();
    let before = |before: GuideStep, end: usize, hops: usize| {
        let guide = make_guide(vec![before, bare_step(GuideStepKind::Straight)]);
        let found = found_in(&GuideTrial::new(&guide, &building), 1, &tree, end, hops);
        places_in(&found, &tables::TURN_BEFORE, [3, 2, 24])
    };
    // 70 degrees are class 16, and 70 to the other side class 7; 40 are 14 and 9.
    assert_eq!(before(turning(GuideStepKind::Turn, Side::Left), 3, 2), [[0, 0, 16]]);
    assert_eq!(before(turning(GuideStepKind::SlightTurn, Side::Right), 2, 1), [[1, 0, 7]]);
    assert_eq!(before(turning(GuideStepKind::TurnAround, Side::Behind), 2, 1), [[2, 0, 7]]);
    assert_eq!(before(turning(GuideStepKind::Stop, Side::Left), 2, 1), [[2, 0, 16]]);
    assert_eq!(before(turning(GuideStepKind::Turn, Side::Left), 1, 1), [[0, 1, 9]]);
    assert!(before(turning(GuideStepKind::Turn, Side::Left), 1, 0).is_empty());
    assert!(before(bare_step(GuideStepKind::Go), 2, 1).is_empty());
}

#[test]
fn stretch_features_count_ways_that_are_squarer_or_straighter_than_those_taken() {
    let (building, mut tree) = corridor();
    for (node, squarer, straighter) in [(1, 1, 0), (2, 3, 1), (3, 0, 2), (4, 1, 0)] {
        tree.nodes[node].ways.squarer = squarer;
        tree.nodes[node].ways.straighter = straighter;
    }
    let squarer =
        |end, hops| single(&building, &tree, bare_step(GuideStepKind::Go), (end, hops), (&tables::SQUARER, [KINDS, 3]));
    assert_eq!(squarer(4, 3), [[8, 2]]);
    assert_eq!(squarer(4, 1), [[8, 1]]);
    assert!(squarer(4, 4).is_empty() && squarer(4, 0).is_empty());
    let straighter =
        |told: GuideStep, end, hops| single(&building, &tree, told, (end, hops), (&tables::STRAIGHTER, [KINDS, 3]));
    let plain = || bare_step(GuideStepKind::Go);
    assert_eq!(straighter(plain(), 4, 3), [[8, 2]]);
    assert_eq!(straighter(plain(), 4, 2), [[8, 1]]);
    assert_eq!(straighter(plain(), 4, 1), [[8, 0]]);
    assert_eq!(straighter(turning(GuideStepKind::Turn, Side::Left), 4, 3), [[0, 1]], "its turn explains the first");
    assert!(straighter(turning(GuideStepKind::Turn, Side::Left), 3, 1).is_empty());
    assert_eq!(straighter(plain(), 2, 2), [[8, 1]], "the opening hop is free");
    assert!(straighter(plain(), 1, 1).is_empty() && straighter(plain(), 4, 0).is_empty());
}

#[test]
fn stretch_features_count_the_ways_to_the_next_turn_s_side_that_are_passed() {
    let (building, mut tree) = corridor();
    tree.nodes[2].ways.aside = [true, false];
    tree.nodes[3].ways.aside = [true, true];
    tree.nodes[4].ways.aside = [true, false];
    let skipped = |side: Side, end, hops| {
        let guide = make_guide(vec![bare_step(GuideStepKind::Go), turning(GuideStepKind::Turn, side)]);
        let found = found_in(&GuideTrial::new(&guide, &building), 0, &tree, end, hops);
        places_in(&found, &tables::SKIPPED, [KINDS, 3, 3])
    };
    assert_eq!(skipped(Side::Left, 4, 3), [[8, 2, 1]]);
    assert_eq!(skipped(Side::Right, 4, 3), [[8, 1, 0]]);
    assert_eq!(skipped(Side::Left, 4, 2), [[8, 1, 1]]);
    assert_eq!(skipped(Side::Left, 4, 0), [[8, 0, 2]]);
    assert!(skipped(Side::Behind, 4, 3).is_empty());
}

#[test]
fn stretch_features_compare_the_storey_in_the_text_with_the_one_where_the_stretch_ends() {
    let mut building = make_building(
        &[(0.0, 0.0, 0.0, "a"), (0.0, 2.0, 1.0, "a"), (0.0, 4.0, 3.0, "a"), (0.0, 6.0, 3.0, "a")],
        &[(0, 1), (1, 2), (2, 3)],
    );
    let tree = WalkTree::single_walk(&building, &[0, 1, 2, 3], 0.0);
    let floor = |number| Some(StoreyMention { number, leaves: false, aside: false });
    let on = |building: &KnownBuilding, change: &dyn Fn(&mut GuideStep)| {
        let told = || changed(GuideStepKind::Go, change);
        let levels = single(building, &tree, told(), (3, 1), (&tables::LEVEL, [6, 4, 3]));
        (levels, single(building, &tree, told(), (3, 1), (&tables::LEVEL_RISE, [6, 7])))
    };
    // 3 m up from the start of the walk, not of the stretch.
    assert_eq!(on(&building, &|told| told.step.storey = Some(ClimbDirection::Up)), (vec![], vec![[4, 5]]));
    building.viewpoints[3].level = Some(2);
    building.levels = 2;
    assert_eq!(on(&building, &|told| told.step.floor = floor(Some(1))), (vec![[0, 1, 1]], vec![[0, 5]]));
    assert_eq!(on(&building, &|told| told.step.floor = floor(Some(9))), (vec![[3, 1, 1]], vec![[3, 5]]));
    assert_eq!(on(&building, &|told| told.step.floor = floor(None)), (vec![[3, 1, 1]], vec![[3, 5]]));
    building.viewpoints[3].level = Some(7);
    building.levels = 7;
    assert_eq!(on(&building, &|told| told.step.storey = Some(ClimbDirection::Down)), (vec![[5, 3, 2]], vec![[5, 5]]));
    assert_eq!(on(&building, &|_| {}), (vec![], vec![]));
}

#[test]
fn stretch_features_mirror_turns_to_the_side_in_the_text() {
    let (building, mut tree) = corridor();
    for (node, deg) in [(1, 40.0f64), (2, -70.0), (3, 20.0), (4, 37.0)] {
        tree.nodes[node].turn_rad = deg.to_radians();
    }
    let angles = |told: &GuideStep, end, hops, table| {
        let places = single(&building, &tree, told.clone(), (end, hops), (table, [KINDS, 24]));
        places.into_iter().map(|[_, angle]| angle).collect::<Vec<_>>()
    };
    let (plain, left, right) = (
        bare_step(GuideStepKind::Go),
        turning(GuideStepKind::Turn, Side::Left),
        turning(GuideStepKind::Turn, Side::Right),
    );
    // All four hops turn by 27 degrees, those after the opening by -13.
    let opening = |told| [&tables::OPENING_TURN, &tables::TURN_AFTER_OPENING].map(|table| angles(told, 4, 4, table));
    assert_eq!(opening(&plain), [[13], [12]]);
    assert_eq!(opening(&left), [[10], [12]]);
    assert_eq!(opening(&right), [[13], [11]]);
    assert!(angles(&plain, 4, 4, &tables::FIRST_TURN).is_empty());
    assert!(angles(&plain, 4, 4, &tables::WHOLE_TURN).is_empty());
    let later = |told| [&tables::FIRST_TURN, &tables::WHOLE_TURN].map(|table| angles(told, 4, 3, table));
    assert_eq!(later(&plain), [[16], [12]]);
    assert_eq!(later(&left), [[16], [12]]);
    assert_eq!(later(&right), [[7], [11]]);
    assert!(angles(&plain, 4, 3, &tables::OPENING_TURN).is_empty());
    assert_eq!(angles(&right, 2, 2, &tables::WIDEST_TURN), [7], "the opening turn is not the widest");
    assert_eq!(angles(&right, 4, 4, &tables::WIDEST_TURN), [7]);
    assert_eq!(angles(&right, 4, 2, &tables::WIDEST_TURN), [14]);
    assert!(angles(&right, 4, 1, &tables::WIDEST_TURN).is_empty());
    assert!(angles(&right, 4, 0, &tables::WHOLE_TURN).is_empty());
}

#[test]
fn stretch_features_count_clear_turns_after_the_first_hop() {
    let (building, mut tree) = corridor();
    for (node, rad) in [(1, 1.0), (2, 0.8), (3, -0.9), (4, 0.65), (5, 1.0), (6, 2.0)] {
        tree.nodes[node].turn_rad = rad;
    }
    let later = |end, hops| {
        single(&building, &tree, bare_step(GuideStepKind::Go), (end, hops), (&tables::LATER_TURNS, [KINDS, 3]))
    };
    assert_eq!(later(2, 2), [[8, 1]]);
    assert_eq!(later(4, 2), [[8, 0]]);
    assert_eq!(later(4, 3), [[8, 1]]);
    assert_eq!(later(6, 6), [[8, 2]]);
    assert!(later(3, 1).is_empty());
}

#[test]
fn stretch_features_wrap_the_sum_of_turns() {
    let (building, mut tree) = corridor();
    tree.nodes[2].turn_rad = 100.0f64.to_radians();
    tree.nodes[3].turn_rad = 120.0f64.to_radians();
    let told = turning(GuideStepKind::Turn, Side::Right);
    // 220 degrees to the right are 140 to the left: class 2.
    assert_eq!(single(&building, &tree, told, (3, 2), (&tables::WHOLE_TURN, [KINDS, 24])), [[0, 2]]);
}

#[test]
fn stretch_features_compare_the_bend_with_the_side_of_a_door() {
    let (building, mut tree) = corridor();
    tree.nodes[2].turn_rad = -70.0f64.to_radians();
    let side = |relation, side, hops| {
        let told = changed(GuideStepKind::Go, |told| told.step.side = Some((relation, side)));
        single(&building, &tree, told, (2, hops), (&tables::SIDE_OF_TURN, [4, 12]))
    };
    use StepRelation::{Along, Into, Past, Plain, Through, To, With};
    for (relation, group) in [(Into, 0), (Through, 0), (To, 1), (Along, 1), (Past, 2), (With, 2), (Plain, 3)] {
        assert_eq!(side(relation, Side::Left, 1), [[group, 8]]);
        assert_eq!(side(relation, Side::Right, 1), [[group, 3]]);
        assert!(side(relation, Side::Right, 0).is_empty());
    }
}

#[test]
fn stretch_features_compare_the_rise_with_the_climb_in_the_text() {
    let building = make_building(
        &[(0.0, 0.0, 0.0, "a"), (0.0, 2.0, 0.3, "a"), (0.0, 4.0, 1.5, "a"), (0.0, 6.0, 1.4, "a")],
        &[(0, 1), (1, 2), (2, 3)],
    );
    let tree = WalkTree::single_walk(&building, &[0, 1, 2, 3], 0.0);
    let rise = |climb, end, hops| {
        let told = changed(GuideStepKind::Climb, |told| told.step.climb = climb);
        single(&building, &tree, told, (end, hops), (&tables::RISE, [2, 11]))
    };
    // 1.2 m lie between the limits at 1 and 2 m.
    assert_eq!(rise(Some(ClimbDirection::Up), 2, 1), [[0, 8]]);
    assert_eq!(rise(Some(ClimbDirection::Down), 2, 1), [[0, 2]]);
    assert_eq!(rise(None, 2, 1), [[1, 8]]);
    // 0.1 m down, and nothing.
    assert_eq!(rise(Some(ClimbDirection::Up), 3, 1), [[0, 5]]);
    assert_eq!(rise(None, 3, 0), [[1, 5]]);
}

#[test]
fn stretch_features_give_the_ways_up_and_down_at_both_ends_of_stairs() {
    let (mut building, tree) = corridor();
    building.viewpoints[2].climbs = [true, false];
    building.viewpoints[4].climbs = [false, true];
    let stairs = |stairs, climb| {
        let told = changed(GuideStepKind::Climb, |told| {
            told.step.stairs = stairs;
            told.step.climb = climb;
        });
        single(&building, &tree, told, (4, 2), (&tables::STAIRS_AT, [3, 2, 2, 4]))
    };
    assert_eq!(stairs(StepStairs::Named, None), [[0, 0, 0, 2], [0, 0, 1, 1]]);
    assert_eq!(stairs(StepStairs::Top, Some(ClimbDirection::Up)), [[1, 1, 0, 2], [1, 1, 1, 1]]);
    assert_eq!(stairs(StepStairs::Bottom, None), [[2, 0, 0, 2], [2, 0, 1, 1]]);
    assert!(stairs(StepStairs::None, None).is_empty());
}

#[test]
fn stretch_features_count_changes_of_room() {
    let building = make_corridor(&["a", "a", "b", "b", "c", "d", "e", "e", "e"]);
    let tree = WalkTree::single_walk(&building, &[0, 1, 2, 3, 4, 5, 6, 7, 8], 0.0);
    let told = || {
        changed(GuideStepKind::Cross, |told| {
            told.step.door = StepDoor::Through;
            told.step.marks = vec![2, 5];
        })
    };
    let ends = |end, hops| single(&building, &tree, told(), (end, hops), (&tables::CROSSING_ENDS, [4, 2, 2, 2, 2]));
    assert_eq!(ends(2, 1), [[3, 1, 0, 1, 1]]);
    assert_eq!(ends(2, 2), [[3, 1, 1, 0, 1]]);
    assert_eq!(ends(3, 2), [[3, 1, 1, 1, 0]]);
    assert!(ends(2, 0).is_empty());
    let crossings = |end, hops| single(&building, &tree, told(), (end, hops), (&tables::CROSSINGS, [4, 4]));
    assert_eq!(
        [crossings(1, 1), crossings(2, 1), crossings(4, 3), crossings(8, 7)].concat(),
        [[3, 0], [3, 1], [3, 2], [3, 3]]
    );
    let same = |end, hops| single(&building, &tree, told(), (end, hops), (&tables::SAME_ROOM, [KINDS, 2]));
    assert_eq!([same(1, 1), same(2, 1), same(2, 0)].concat(), [[7, 1], [7, 0], [7, 1]]);
    let border = |end| single(&building, &tree, told(), (end, 1), (&tables::BORDER, [4, 2, 3]));
    assert_eq!([border(1), border(7), border(5)].concat(), [[3, 1, 1], [3, 1, 0], [3, 1, 2]]);
    let marks = |end, hops| single(&building, &tree, told(), (end, hops), (&tables::MARK_CROSSINGS, [90, 3]));
    assert_eq!(marks(8, 7), [[2, 2], [5, 2]]);
    assert_eq!(marks(2, 1), [[2, 1], [5, 1]]);
}

#[test]
fn stretch_features_give_every_marking_word_the_hops_and_the_bend() {
    let (building, mut tree) = corridor();
    tree.nodes[2].turn_rad = -60.0f64.to_radians();
    let told = || changed(GuideStepKind::Go, |told| told.step.marks = vec![7]);
    let hops = |end, hops| single(&building, &tree, told(), (end, hops), (&tables::MARK_HOPS, [90, 5]));
    assert_eq!([hops(6, 5), hops(6, 4), hops(6, 1), hops(6, 0)].concat(), [[7, 4], [7, 4], [7, 1], [7, 0]]);
    let bend = |end, hops| single(&building, &tree, told(), (end, hops), (&tables::MARK_TURN, [90, 4]));
    assert_eq!([bend(3, 2), bend(4, 1)].concat(), [[7, 2], [7, 0]]);
    assert!(bend(3, 0).is_empty());
}

#[test]
fn stretch_features_note_whether_a_way_goes_straight_on() {
    let (building, mut tree) = corridor();
    tree.nodes[4].ways.onward = false;
    let onward = |at_end, end| {
        let told = changed(GuideStepKind::Go, |told| told.step.at_end = at_end);
        single(&building, &tree, told, (end, 1), (&tables::ONWARD, [KINDS, 2, 2]))
    };
    assert_eq!([onward(false, 3), onward(true, 3), onward(true, 4)].concat(), [[8, 0, 1], [8, 1, 1], [8, 1, 0]]);
}

/// A place with its distance classes along the corridor.
fn located<'a>(
    mention: &'a GuideMention,
    class: [usize; 9],
    nearest: [f64; 2],
    commonness: usize,
) -> LocatedMention<'a> {
    let nearest = vec![Some(DVec3::new(nearest[0], nearest[1], 1.5)); 9];
    let near = Arc::new(PlaceNearness { class: class.to_vec(), nearest, commonness, exists: true });
    LocatedMention { mention, is_room: mention.meanings[0].is_room, near }
}

/// A guide of one step over the corridor that names one located place.
fn place_found(
    mention: &GuideMention,
    (class, nearest, commonness): ([usize; 9], [f64; 2], usize),
    (steps, step): (usize, usize),
    (end, hops): (usize, usize),
) -> Vec<u32> {
    let (building, tree) = corridor();
    let guide = make_guide(vec![bare_step(GuideStepKind::Go); steps]);
    let mut found: Vec<Vec<LocatedMention<'_>>> = (0..steps).map(|_| Vec::new()).collect();
    found[step].push(located(mention, class, nearest, commonness));
    let trial = GuideTrial { guide: &guide, building: &building, located: found, is_room_named: vec![None; 9] };
    found_in(&trial, step, &tree, end, hops)
}

const CLASSES: [usize; 9] = [5, 4, 3, 1, 2, 2, 0, 1, 5];

#[test]
fn place_features_give_the_distance_at_the_begin_the_nearest_point_and_the_end() {
    let number = StepRelation::Past as usize;
    let thing = make_mention(StepRelation::Past, false, "sofa");
    let found = place_found(&thing, (CLASSES, [1.0, 6.0], 2), (1, 0), (4, 2));
    assert_eq!(
        places_in(&found, &tables::THING, [14, 3, 3, 7]),
        [[number, 2, 0, 3], [number, 2, 1, 1], [number, 2, 2, 2]]
    );
    assert_eq!(places_in(&found, &tables::GROUP_THING, [6, 3, 7]), [[3, 0, 3], [3, 1, 1], [3, 2, 2]]);
    assert_eq!(places_in(&found, &tables::THING_AT_END, [14, 7]), [[number, 2]]);
    assert!(places_in(&found, &tables::ROOM, [14, 3, 7]).is_empty());
    assert!(places_in(&found, &tables::ROOM_MOVE, [14, 4]).is_empty());
    assert!(places_in(&found, &tables::TURN_AT, [2, 7]).is_empty());
    let earlier = place_found(&thing, (CLASSES, [1.0, 6.0], 2), (2, 0), (4, 2));
    assert!(places_in(&earlier, &tables::THING_AT_END, [14, 7]).is_empty(), "it is not the last step");

    let number = StepRelation::Into as usize;
    let mut room = make_mention(StepRelation::Into, true, "kitchen");
    room.tells_turn = true;
    let found = place_found(&room, (CLASSES, [1.0, 6.0], 1), (2, 1), (6, 3));
    assert_eq!(places_in(&found, &tables::ROOM, [14, 3, 7]), [[number, 0, 1], [number, 1, 0], [number, 2, 0]]);
    assert_eq!(places_in(&found, &tables::GROUP_ROOM, [6, 3, 7]), [[1, 0, 1], [1, 1, 0], [1, 2, 0]]);
    assert_eq!(places_in(&found, &tables::ROOM_AT_END, [14, 7]), [[number, 0]]);
    assert_eq!(places_in(&found, &tables::TURN_AT, [2, 7]), [[1, 1]]);
    assert!(places_in(&found, &tables::THING, [14, 3, 3, 7]).is_empty());
    // From near to near, from near to far, from far to near, and from far to far.
    for (end, hops, moves) in [(6, 3, 3), (4, 1, 2), (6, 2, 1), (5, 1, 0)] {
        let found = place_found(&room, (CLASSES, [1.0, 6.0], 1), (2, 1), (end, hops));
        assert_eq!(places_in(&found, &tables::ROOM_MOVE, [14, 4]), [[number, moves]]);
    }
}

#[test]
fn place_features_compare_the_direction_of_the_stretch_with_that_of_the_place() {
    let mention = make_mention(StepRelation::To, false, "sofa");
    let number = StepRelation::To as usize;
    let towards = |nearest: [f64; 2], end, hops| {
        let found = place_found(&mention, (CLASSES, nearest, 0), (1, 0), (end, hops));
        places_in(&found, &tables::TOWARDS, [14, 2, 4])
    };
    // The stretch leads north from (0, 4). Angles of 11, 45, 79, 90 and 135 degrees.
    assert_eq!(towards([1.0, 9.0], 4, 2), [[number, 0, 0]]);
    assert_eq!(towards([-3.0, 7.0], 4, 2), [[number, 0, 1]]);
    assert_eq!(towards([5.0, 5.0], 4, 2), [[number, 0, 2]]);
    assert_eq!(towards([-3.0, 4.0], 4, 2), [[number, 0, 2]]);
    assert_eq!(towards([3.0, 1.0], 4, 2), [[number, 0, 3]]);
    assert!(towards([0.0, 4.5], 4, 2).is_empty(), "it is too near");
    assert!(towards([0.0, 18.5], 4, 2).is_empty(), "it is too far");
    assert!(towards([0.0, 9.0], 2, 0).is_empty(), "a stretch without hops has no direction");
    let room = make_mention(StepRelation::To, true, "kitchen");
    let found = place_found(&room, (CLASSES, [1.0, 9.0], 0), (1, 0), (4, 2));
    assert_eq!(places_in(&found, &tables::TOWARDS, [14, 2, 4]), [[number, 1, 0]]);
}

#[test]
fn place_features_mirror_the_side_of_a_place() {
    let side = |side, class, nearest: [f64; 2]| {
        let mut mention = make_mention(StepRelation::With, false, "sofa");
        mention.side = side;
        let found = place_found(&mention, (class, nearest, 0), (1, 0), (5, 4));
        places_in(&found, &tables::SIDE_OF_PLACE, [12]).concat()
    };
    // Nearest at viewpoint 3, at (0, 6), looking north: 72 degrees to the right.
    assert_eq!(side(Some(Side::Right), CLASSES, [3.0, 7.0]), [8]);
    assert_eq!(side(Some(Side::Left), CLASSES, [3.0, 7.0]), [3]);
    assert_eq!(side(Some(Side::Left), CLASSES, [-3.0, 7.0]), [8]);
    assert!(side(Some(Side::Ahead), CLASSES, [3.0, 7.0]).is_empty());
    assert!(side(None, CLASSES, [3.0, 7.0]).is_empty());
    assert!(side(Some(Side::Left), [5; 9], [3.0, 7.0]).is_empty(), "it is far everywhere");
    assert!(side(Some(Side::Left), [6; 9], [3.0, 7.0]).is_empty(), "no one knows where it is");
}

#[test]
fn place_features_give_the_direction_of_a_place_from_the_end() {
    let mention = make_mention(StepRelation::To, true, "kitchen");
    let number = StepRelation::To as usize;
    let ahead = |nearest: [f64; 2], class: usize| {
        let found = place_found(&mention, ([class; 9], nearest, 0), (1, 0), (4, 2));
        places_in(&found, &tables::AHEAD, [14, 2, 3, 4])
    };
    // The stretch ends at (0, 8), looking north. Angles of 27, 63, 117 and 153 degrees.
    for (nearest, angle) in [([1.0, 10.0], 0), ([-4.0, 10.0], 1), ([4.0, 6.0], 2), ([-1.0, 6.0], 3)] {
        for (class, near) in [(0, 0), (1, 0), (2, 1), (3, 2), (4, 2)] {
            assert_eq!(ahead(nearest, class), [[number, 1, near, angle]]);
        }
    }
    assert!(ahead([1.0, 10.0], 5).is_empty() && ahead([1.0, 10.0], 6).is_empty());
    assert!(ahead([0.0, 8.2], 0).is_empty(), "it is too near to have a direction");
}

#[test]
fn place_features_note_whether_the_place_was_or_comes_nearer() {
    let mention = make_mention(StepRelation::At, false, "sofa");
    let nearest = |end, hops, steps| {
        let found = place_found(&mention, (CLASSES, [0.0, 0.0], 0), (steps, 0), (end, hops));
        places_in(&found, &tables::NEAREST, [6, 2, 2, 4])
    };
    // Classes along the corridor: 5 4 3 1 2 2 0 1 5.
    assert_eq!(nearest(3, 2, 1), [[2, 0, 1, 0]]);
    assert_eq!(nearest(2, 1, 2), [[2, 0, 0, 1]]);
    assert_eq!(nearest(8, 1, 2), [[2, 0, 0, 3]]);
    assert_eq!(nearest(5, 1, 1), [[2, 0, 1, 1]]);
    let mut far = CLASSES;
    far[4] = 3;
    far[5] = 3;
    far[6] = 5;
    let found = place_found(&mention, (far, [0.0, 0.0], 0), (1, 0), (5, 2));
    assert_eq!(places_in(&found, &tables::NEAREST, [6, 2, 2, 4]), [[2, 0, 1, 2]]);
}

/// The features of the whole corridor's walk, or of a part of it.
fn ending(guide: &Guide, change: impl FnOnce(&mut GuideTrial<'_>), end: usize, turns: &[(usize, f64)]) -> Vec<u32> {
    let (building, mut tree) = corridor();
    for (node, rad) in turns {
        tree.nodes[*node].turn_rad = *rad;
    }
    let mut trial = GuideTrial::new(guide, &building);
    change(&mut trial);
    let mut found = Vec::new();
    ending_features(&trial, &tree, end, &mut found);
    found
}

#[test]
fn ending_features_of_an_empty_text_are_the_length_of_the_walk() {
    let guide = make_guide(Vec::new());
    // 2 m for each hop, with limits at 2, 4, 6, 8, 10, 13 and 16 m.
    for (end, class) in [(1, 1), (3, 3), (6, 5), (7, 6), (8, 7)] {
        let found = ending(&guide, |_| {}, end, &[]);
        assert_eq!(places_in(&found, &tables::UNTOLD_HOPS, [12]), [[end]]);
        assert_eq!(places_in(&found, &tables::UNTOLD_LENGTH, [8]), [[class]]);
        assert_eq!(found.len(), 2);
    }
    let long = make_corridor(&["a"; 15]);
    let tree = WalkTree::single_walk(&long, &(0..15).collect::<Vec<_>>(), 0.0);
    let mut found = Vec::new();
    ending_features(&GuideTrial::new(&guide, &long), &tree, 14, &mut found);
    assert_eq!(places_in(&found, &tables::UNTOLD_HOPS, [12]), [[11]]);
}

#[test]
fn ending_features_count_clear_turns_in_the_text_and_on_the_walk() {
    let steps = |count| vec![turning(GuideStepKind::Turn, Side::Left); count];
    let turns = [(1, 2.0), (2, 0.7), (3, 0.9), (4, -0.9)];
    let told = |count, end| {
        let found = ending(&make_guide(steps(count)), |_| {}, end, &turns);
        places_in(&found, &tables::TURNS_TOLD, [7, 7])
    };
    assert_eq!([told(1, 2), told(2, 3), told(7, 4)].concat(), [[1, 0], [2, 1], [5, 2]]);
    let mut goal = make_guide(steps(1));
    goal.is_goal = true;
    assert_eq!(places_in(&ending(&goal, |_| {}, 4, &turns), &tables::TURNS_TOLD, [7, 7]), [[6, 2]]);
}

#[test]
fn ending_features_compare_the_last_places_with_the_end_and_all_with_the_walk() {
    let mentions = [
        make_mention(StepRelation::To, true, "attic"),
        make_mention(StepRelation::OutOf, true, "kitchen"),
        make_mention(StepRelation::At, false, "sofa"),
        make_mention(StepRelation::With, false, "lamp"),
    ];
    for is_goal in [false, true] {
        let mut guide = make_guide(vec![bare_step(GuideStepKind::Go); 2]);
        guide.is_goal = is_goal;
        let (building, tree) = corridor();
        let mut trial = GuideTrial::new(&guide, &building);
        trial.located[0].push(located(&mentions[0], [2, 3, 4, 5, 5, 5, 5, 5, 5], [0.0; 2], 0));
        trial.located[0].push(located(&mentions[2], [5, 5, 5, 5, 5, 0, 0, 0, 0], [0.0; 2], 1));
        trial.located[1].push(located(&mentions[1], [5, 4, 3, 3, 4, 5, 5, 5, 5], [0.0; 2], 0));
        trial.located[1].push(located(&mentions[3], [5, 5, 2, 5, 1, 4, 4, 4, 4], [0.0; 2], 2));
        let mut found = Vec::new();
        ending_features(&trial, &tree, 4, &mut found);
        let goal = usize::from(is_goal);
        assert_eq!(places_in(&found, &tables::LAST_ROOM, [2, 6, 7]), [[goal, 0, 4]]);
        assert_eq!(places_in(&found, &tables::LAST_THING, [2, 6, 7]), [[goal, 4, 1]]);
        assert_eq!(places_in(&found, &tables::NAMED_ROOM, [2, 7]), [[goal, 2], [goal, 3]]);
        assert_eq!(places_in(&found, &tables::NAMED_THING, [2, 3, 7]), [[goal, 1, 5], [goal, 2, 1]]);
    }
}

#[test]
fn ending_features_count_the_rooms_that_the_text_does_not_name() {
    let building = make_corridor(&["a", "a", "b", "b", "c", "d", "e", "f", "g"]);
    let tree = WalkTree::single_walk(&building, &[0, 1, 2, 3, 4, 5, 6, 7, 8], 0.0);
    let guide = make_guide(vec![bare_step(GuideStepKind::Go)]);
    let found = |end: usize, tells: [Option<bool>; 9]| {
        let mut trial = GuideTrial::new(&guide, &building);
        trial.is_room_named = tells.to_vec();
        let mut found = Vec::new();
        ending_features(&trial, &tree, end, &mut found);
        (
            places_in(&found, &tables::UNNAMED_PASSED, [2, 5]).concat(),
            places_in(&found, &tables::UNNAMED_END, [2, 2, 3]).concat(),
        )
    };
    let none = [Some(false); 9];
    // The room "a" counts only from the second viewpoint on, and each room once.
    assert_eq!(found(3, none).0, [0, 2]);
    assert_eq!(found(8, none).0, [0, 4]);
    // Two of nine viewpoints are many, one is some.
    assert_eq!(found(3, none).1, [0, 0, 2]);
    assert_eq!(found(4, none).1, [0, 0, 1]);
    let mut some = none;
    some[1] = Some(true);
    some[3] = Some(true);
    assert_eq!(found(3, some), (vec![0, 1], vec![0, 1, 2]));
    some[4] = None;
    assert_eq!(found(4, some), (vec![0, 1], vec![]));
    assert_eq!(found(0, none).0, [0, 0], "the start does not count");
}

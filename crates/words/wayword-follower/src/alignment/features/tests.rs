use super::*;
use crate::{
    alignment::tests::{TEXT, corner, read_parted, whole_walk},
    features::tables::FeatureTable,
    made_buildings::make_building,
    weights::FeatureWeights,
};

/// Four viewpoints every 2 m to the north, at the heights 0.5, 0, 1 and 1.25 m.
fn stairs() -> KnownBuilding {
    let places = [(0.0, 0.0, 0.5, ""), (0.0, 2.0, 0.0, ""), (0.0, 4.0, 1.0, ""), (0.0, 6.0, 1.25, "")];
    make_building(&places, &[(0, 1), (1, 2), (2, 3)])
}

/// The features of the words of a part on a stretch of the walk through all viewpoints.
fn word_features(text: &str, building: &KnownBuilding, part: usize, stretch: [usize; 2]) -> Vec<ValuedFeature> {
    let parted = read_parted(text);
    assert_eq!(parted.parts.len(), 3, "{text}");
    let case = whole_walk(&parted, building, 0.0, &FeatureWeights::all_zero());
    let mut found = Vec::new();
    case.trial.word_features(part, stretch, 0.5, &mut found);
    found
}

/// For climbs on a stretch of the stairs, the classes of the rise of the stretch, of the hop after it and of the hop before it.
fn climb_classes(text: &str, stretch: [usize; 2]) -> [Option<usize>; 3] {
    let found = word_features(text, &stairs(), 1, stretch);
    [CLIMB_RISE, CLIMB_AFTER, CLIMB_BEFORE]
        .map(|table| (0..RISES).find(|class| found.contains(&(table.feature_at([(*class, RISES)]), 1.0))))
}

#[test]
fn a_climb_is_compared_with_the_rise_of_its_stretch_and_of_the_hops_beside_it() {
    let up = "Walk past the sofa. Go up the stairs. Turn around.";
    assert_eq!(climb_classes(up, [1, 2]), [Some(6), Some(4), Some(1)]);
    assert_eq!(climb_classes(up, [0, 0]), [Some(3), Some(1), None]);
    assert_eq!(climb_classes(up, [0, 3]), [Some(6), None, None]);
    let down = "Walk past the sofa. Go down the stairs. Turn around.";
    assert_eq!(climb_classes(down, [1, 2]), [Some(1), Some(2), Some(5)]);
}

#[test]
fn a_part_without_a_climb_is_told_how_much_its_stretch_rises() {
    let has_rise = |text: &str, stretch: [usize; 2], has_climb: usize, class: usize| {
        let feature = FLAT_RISE.feature_at([(has_climb, 2), (PartKind::Pass as usize, KINDS), (class, WIDTHS)]);
        word_features(text, &stairs(), 0, stretch).contains(&(feature, 1.0))
    };
    let climbs = "Walk past the sofa. Go up the stairs. Turn around.";
    assert!(has_rise(climbs, [0, 0], 1, 0));
    assert!(has_rise(climbs, [0, 1], 1, 2), "half a metre down");
    assert!(has_rise(climbs, [1, 2], 1, 3), "a metre up");
    assert!(has_rise(TEXT, [1, 2], 0, 3), "no part of the text climbs");
}

#[test]
fn a_rise_ends_with_the_walk() {
    let parted = read_parted(TEXT);
    let case = whole_walk(&parted, &stairs(), 0.0, &FeatureWeights::all_zero());
    let rises = [[1, 2], [2, 1], [0, 3], [0, 9]].map(|[from, to]| case.trial.walk.rise_m(from, to));
    assert_eq!(rises, [1.0, -1.0, 0.75, 0.75]);
}

#[test]
fn a_stretch_has_the_class_of_its_length() {
    let parted = read_parted(TEXT);
    let case = whole_walk(&parted, &corner(), 0.0, &FeatureWeights::all_zero());
    // The viewpoints lie 2 m apart.
    let stretches = [[0, 0], [3, 3], [0, 1], [2, 3], [1, 3], [1, 5]];
    assert_eq!(stretches.map(|stretch| case.trial.metres_class(stretch)), [0, 0, 2, 2, 4, 6]);
}

#[test]
fn the_kinds_of_the_parts_before_and_after_count() {
    const NONE: usize = KINDS;
    let kinds = [PartKind::Pass, PartKind::BareTurn, PartKind::Stop].map(|kind| kind as usize);
    let beside = [(NONE, kinds[1]), (kinds[0], kinds[2]), (kinds[1], NONE)];
    for (part, (before, next)) in beside.into_iter().enumerate() {
        for (stretch, hops) in [([2, 2], 0), ([1, 3], 2), ([0, 5], 3)] {
            let found = word_features(TEXT, &corner(), part, stretch);
            let feature = |table: FeatureTable, other: usize| {
                (table.feature_at([(kinds[part], KINDS), (other, KINDS + 1), (hops, 4)]), 1.0)
            };
            assert!(found.contains(&feature(KIND_NEXT, next)), "{part} {stretch:?}: {found:?}");
            assert!(found.contains(&feature(KIND_BEFORE, before)), "{part} {stretch:?}: {found:?}");
        }
    }
}

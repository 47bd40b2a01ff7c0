//! The alignment on small walks: along a straight corridor, and around a corner.

use super::*;
use crate::{
    features::tables as step_tables,
    guide::GuideStepKind,
    made_buildings::{make_building, make_corridor, random_weights},
};
use rand::Rng;
use std::collections::BTreeSet;
use wayword_core::seeded_rng;
use wayword_language::reading::read_instruction;

/// A text of three parts.
pub(super) const TEXT: &str = "Walk past the sofa. Turn right. Stop at the lamp.";

/// Viewpoints at these points (east and north, metres), each with a way to the next.
pub(super) fn building_along(points: &[[f64; 2]]) -> KnownBuilding {
    let places: Vec<_> = points.iter().map(|[east, north]| (*east, *north, 1.5, "")).collect();
    let ways: Vec<_> = (1..points.len()).map(|at| (at - 1, at)).collect();
    make_building(&places, &ways)
}

/// Six viewpoints every 2 m: three hops to the north, and from viewpoint 3 on two to the east.
pub(super) fn corner() -> KnownBuilding {
    building_along(&[[0.0, 0.0], [0.0, 2.0], [0.0, 4.0], [0.0, 6.0], [2.0, 6.0], [4.0, 6.0]])
}

/// 18 viewpoints every 0.5 m: six hops to the north, and from viewpoint 6 on eleven to the east.
pub(super) fn dense_corner() -> KnownBuilding {
    let north = (0..=6).map(|at| [0.0, 0.5 * f64::from(at)]);
    let east = (1..=11).map(|at| [0.5 * f64::from(at), 3.0]);
    building_along(&north.chain(east).collect::<Vec<_>>())
}

/// The places where the walk through [`dense_corner`] is cut: the corner, and every 2 m.
const DENSE_PLACES: [usize; 6] = [0, 4, 6, 10, 14, 17];

pub(super) fn read_parted(text: &str) -> PartedText {
    PartedText::from_reading(text, &read_instruction(text, &BTreeSet::new()))
}

/// The case of a walk through all viewpoints of a building, in their order.
pub(super) fn whole_walk<'a>(
    text: &'a PartedText,
    building: &KnownBuilding,
    heading_rad: f64,
    follower: &FeatureWeights,
) -> AlignmentCase<'a> {
    AlignmentCase::new(text, building, &(0..building.len()).collect::<Vec<_>>(), heading_rad, follower)
}

/// Weights without any pattern, up to a size.
pub(super) fn random_alignment_weights(seed: u64, reading: PartReading, size: f64) -> AlignmentWeights {
    let mut random = seeded_rng(seed, &["alignment weights"]);
    let values = (0..tables::COUNT).map(|_| random.random_range(-size..size)).collect();
    AlignmentWeights { reading, values }
}

/// Weights that only reward a part with a turn if it begins with a turn to its side.
fn turn_weights(reading: PartReading) -> AlignmentWeights {
    let mut weights = AlignmentWeights::all_zero(reading);
    for (opens, bare) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        // 45 degrees and more to the side in the text.
        for angle in 6..tables::ANGLES {
            let feature = tables::TURN_FIRST.feature_at([(opens, 2), (bare, 2), (angle, tables::ANGLES)]);
            weights.values[feature as usize] = 8.0;
        }
    }
    weights
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

fn stretches(alignment: &WalkAlignment) -> Vec<[usize; 2]> {
    alignment.parts.iter().map(|part| part.stretch).collect()
}

#[test]
fn the_part_with_a_turn_takes_the_stretch_with_the_turn() {
    let text = read_parted(TEXT);
    let case = whole_walk(&text, &corner(), 0.0, &FeatureWeights::all_zero());
    let alignment = case.align_parts(&turn_weights(PartReading::Words));
    let spans: Vec<&str> = alignment.parts.iter().map(|part| &TEXT[part.span[0]..part.span[1]]).collect();
    assert_eq!(spans, ["Walk past the sofa", "Turn right", "Stop at the lamp"]);
    let found = stretches(&alignment);
    let turn_end = found[1][1];
    assert_eq!(found, [[0, 3], [3, turn_end], [turn_end, 5]], "{alignment:?}");
    assert!(turn_end > 3, "{alignment:?}");
    assert!(alignment.parts[0].confidence > 0.99, "{alignment:?}");
    assert_eq!(alignment.parts[0].likeliest_end(), 3);
    // It is open whether it takes one hop or two.
    let ends = &alignment.parts[1].end_shares;
    assert!((ends[4] - ends[5]).abs() < 0.001 && ends[4] > 0.49, "{ends:?}");
    assert!((0.49..0.5).contains(&alignment.parts[1].confidence), "{alignment:?}");
}

#[test]
fn a_turn_to_the_other_side_is_not_rewarded() {
    let wrong = read_parted("Walk past the sofa. Turn left. Stop at the lamp.");
    let right = read_parted(TEXT);
    let follower = FeatureWeights::all_zero();
    // With two boundaries in six places there are 21 ways to cut, and 6 - k with the first boundary at k.
    for (text, reading) in [(&wrong, PartReading::Words), (&right, PartReading::WordCounts)] {
        let alignment = whole_walk(text, &corner(), 0.0, &follower).align_parts(&turn_weights(reading));
        for (place, share) in alignment.parts[0].end_shares.iter().enumerate() {
            assert!(near(*share, (6 - place) as f64 / 21.0), "{reading:?} {place}: {share}");
        }
        assert!(alignment.parts.iter().all(|part| part.confidence < 0.3), "{alignment:?}");
    }
}

#[test]
fn the_first_turn_begins_at_the_heading_of_the_walker() {
    let text = read_parted("Turn right. Walk past the sofa.");
    let building = make_corridor(&["hallway"; 3]);
    let stays = |heading_deg: f64| {
        let case = whole_walk(&text, &building, heading_deg.to_radians(), &FeatureWeights::all_zero());
        case.align_parts(&turn_weights(PartReading::Words)).parts[0].end_shares[0]
    };
    assert!(near(stays(0.0), 1.0 / 3.0), "it goes straight on");
    assert!(stays(-90.0) < 0.01, "the first hop turns right, so the part takes it");
    assert!(near(stays(90.0), 1.0 / 3.0), "the first hop turns left");
}

#[test]
fn the_follower_s_score_of_the_steps_counts() {
    let text = read_parted(TEXT);
    let mut values = vec![0.0; step_tables::COUNT];
    // A step with a turn begins with a hop that turns by about 90 degrees to its side.
    for angle in 17..=18 {
        let kind = (GuideStepKind::Turn as usize, GuideStepKind::COUNT);
        values[step_tables::FIRST_TURN.feature_at([kind, (angle, step_tables::ANGLES)]) as usize] = 2.0;
    }
    let case = whole_walk(&text, &corner(), 0.0, &FeatureWeights::from_values(&values));
    let ends = |weight: f64| {
        let mut weights = AlignmentWeights::all_zero(PartReading::Words);
        weights.values[tables::FOLLOWER.from] = weight;
        case.align_parts(&weights).parts[0].end_shares.clone()
    };
    assert!(ends(5.0)[3] > 0.99, "{:?}", ends(5.0));
    assert!(near(ends(0.0)[3], 3.0 / 21.0), "without its weight all cuts are alike: {:?}", ends(0.0));
    assert!(ends(-5.0)[3] < 3.0 / 21.0, "{:?}", ends(-5.0));
}

#[test]
fn a_dense_walk_is_cut_only_at_its_places() {
    let text = read_parted(TEXT);
    let case = whole_walk(&text, &dense_corner(), 0.0, &FeatureWeights::all_zero());
    let alignment = case.align_parts(&turn_weights(PartReading::Words));
    assert_eq!(alignment.parts[0].stretch, [0, 6]);
    assert_eq!(alignment.parts[2].stretch[1], 17);
    for part in &alignment.parts {
        assert_eq!(part.end_shares.len(), 18);
        assert!(near(part.end_shares.iter().sum(), 1.0), "{part:?}");
        let mut reached = (0..18).filter(|at| part.end_shares[*at] > 0.0);
        assert!(reached.all(|at| DENSE_PLACES.contains(&at)), "{part:?}");
        assert!(part.stretch.iter().all(|at| DENSE_PLACES.contains(at)), "{part:?}");
    }
}

#[test]
fn parts_cover_the_walk_without_gaps() {
    let texts = [
        TEXT,
        "Turn around and leave the kitchen. Go up the stairs until you reach the top, then wait by the bed.",
        "Go to the attic and dust the globe.",
        "Walk on.",
    ];
    for (seed, text) in texts.into_iter().enumerate() {
        let parted = read_parted(text);
        for building in [corner(), dense_corner(), make_corridor(&["hallway"; 12]), make_corridor(&["hallway"])] {
            let case = whole_walk(&parted, &building, 0.4, &random_weights(seed as u64));
            for reading in [PartReading::Words, PartReading::WordCounts] {
                let weights = random_alignment_weights(seed as u64, reading, 1.0);
                let alignment = case.align_parts(&weights);
                assert_eq!(alignment.parts.len(), parted.parts.len());
                let mut begin = 0;
                for part in &alignment.parts {
                    let [from, to] = part.stretch;
                    assert!(from == begin && from <= to, "{text}: {alignment:?}");
                    assert!((0.0..=1.0 + 1e-9).contains(&part.confidence), "{text}: {part:?}");
                    assert!(part.confidence <= part.end_shares[to] + 1e-9, "{text}: {part:?}");
                    assert!(near(part.end_shares.iter().sum(), 1.0), "{text}: {part:?}");
                    begin = to;
                }
                assert_eq!(begin + 1, building.len(), "{text}: {alignment:?}");
            }
        }
    }
}

#[test]
fn a_walk_of_one_place_belongs_to_every_part() {
    let text = read_parted(TEXT);
    let weights = random_alignment_weights(1, PartReading::Words, 1.0);
    let case = AlignmentCase::new(&text, &corner(), &[2], 0.0, &random_weights(1));
    for part in case.align_parts(&weights).parts {
        assert!(part.stretch == [0, 0] && near(part.confidence, 1.0) && part.end_shares.len() == 1, "{part:?}");
    }
}

#[test]
fn a_part_without_words_takes_a_stretch_as_well() {
    let text = "Turn right.";
    let parted = PartedText::from_spans(text, &[[0, 10], [50, 60]]);
    let case = whole_walk(&parted, &corner(), 0.0, &random_weights(2));
    let alignment = case.align_parts(&AlignmentWeights::all_zero(PartReading::Words));
    assert!(alignment.parts[1].end_shares[5] > 0.99 && alignment.parts[0].stretch[0] == 0, "{alignment:?}");
    for share in &alignment.parts[0].end_shares {
        assert!(near(*share, 1.0 / 6.0), "{alignment:?}");
    }
}

#[test]
fn median_and_likeliest_end_follow_the_shares() {
    let ends = |shares: &[f64]| {
        let part = AlignedPart { span: [0, 1], stretch: [0, 0], confidence: 1.0, end_shares: shares.to_vec() };
        (part.median_end(), part.likeliest_end())
    };
    assert_eq!(ends(&[0.2, 0.2, 0.35, 0.25]), (2, 2));
    assert_eq!(ends(&[0.4, 0.0, 0.3, 0.3]), (2, 0));
    assert_eq!(ends(&[0.25, 0.25, 0.5]), (1, 2), "one half is reached");
    assert_eq!(ends(&[0.0, 0.5, 0.5]), (1, 1), "the first of two that are equally likely");
    assert_eq!(ends(&[1.0]), (0, 0));
    assert_eq!(ends(&[0.2, 0.2]), (1, 0), "shares that are rounded down end at the last place");
    assert_eq!(ends(&[]), (0, 0));
}

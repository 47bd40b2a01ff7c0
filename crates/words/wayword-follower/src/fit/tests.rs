use super::*;
use crate::{
    FeatureWeights, Guide, KnownBuilding, WalkPrior, best_walk,
    guide::GuideStepKind,
    made_buildings::{bare_step, make_corridor, make_guide, random_weights},
    tests::surveyed,
    walk_shares,
};

const TEXTS: [&str; 4] = [
    "Walk down the hallway and turn right. Walk into the kitchen and wait by the oven.",
    "Go past the plant, turn left and stop at the bed.",
    "Dust the oven.",
    "",
];

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9 || a == b
}

/// The sum over all ways to cut the rest of a walk into stretches, one for each of the first steps from `step` on.
fn sum_of_cuts(
    (trial, tree, weights): (&GuideTrial<'_>, &WalkTree, &FeatureWeights),
    walk: &[usize],
    steps: std::ops::Range<usize>,
    at: usize,
) -> f64 {
    if steps.is_empty() {
        return if at + 1 == walk.len() { 1.0 } else { 0.0 };
    }
    let mut sum = 0.0;
    for to in at..walk.len().min(at + 9) {
        let mut found = Vec::new();
        stretch_features(trial, steps.start, &WalkStretch::to_node(tree, walk[to], to - at), &mut found);
        let rest = sum_of_cuts((trial, tree, weights), walk, steps.start + 1..steps.end, to);
        sum += weights.sum_weights(&found).exp() * rest;
    }
    sum
}

fn nodes_of(tree: &WalkTree, walk: usize) -> Vec<usize> {
    let mut nodes: Vec<usize> = tree.nodes_back(walk).collect();
    nodes.reverse();
    nodes
}

#[test]
fn walk_fit_is_the_sum_over_all_cuts_of_each_walk() {
    let building = KnownBuilding::from_survey(&surveyed());
    for (seed, text) in TEXTS.into_iter().enumerate() {
        let guide = Guide::read_text(text);
        let trial = GuideTrial::new(&guide, &building);
        let weights = random_weights(seed as u64);
        let tree = WalkTree::from_prior(&building, 0, 0.1, WalkPrior::Shortest(8));
        let fit = WalkFit::new(&trial, &tree, &weights);
        for walk in 0..tree.len() {
            let nodes = nodes_of(&tree, walk);
            let mut ending = Vec::new();
            ending_features(&trial, &tree, walk, &mut ending);
            let cuts =
                if guide.is_empty() { 1.0 } else { sum_of_cuts((&trial, &tree, &weights), &nodes, 0..guide.len(), 0) };
            let expected = cuts.ln() + weights.sum_weights(&ending);
            assert!(near(fit.score(walk), expected), "{text} {walk}: {} {expected}", fit.score(walk));
            for steps in 1..=guide.len() {
                let expected = sum_of_cuts((&trial, &tree, &weights), &nodes, 0..steps, 0).ln();
                assert!(near(fit.sum_after(steps, walk), expected), "{text} {walk} {steps}");
            }
        }
    }
}

#[test]
fn walk_fit_lets_a_step_lead_eight_hops_at_most() {
    let building = make_corridor(&["hallway"; 18]);
    let tree = WalkTree::single_walk(&building, &(0..18).collect::<Vec<_>>(), 0.0);
    let weights = random_weights(1);
    let is_possible = |steps: usize, hops: usize| {
        let guide = make_guide(vec![bare_step(GuideStepKind::Go); steps]);
        WalkFit::new(&GuideTrial::new(&guide, &building), &tree, &weights).score(hops).is_finite()
    };
    assert_eq!(
        [is_possible(1, 8), is_possible(1, 9), is_possible(2, 16), is_possible(2, 17)],
        [true, false, true, false]
    );
}

#[test]
fn walk_shares_are_the_parts_of_all_walks_but_the_start() {
    let building = KnownBuilding::from_survey(&surveyed());
    let guide = Guide::read_text(TEXTS[0]);
    let tree = WalkTree::from_prior(&building, 0, 0.0, WalkPrior::Shortest(8));
    for seed in 0..5 {
        let fit = WalkFit::new(&GuideTrial::new(&guide, &building), &tree, &random_weights(seed));
        let whole: f64 = (1..tree.len()).map(|walk| fit.score(walk).exp()).sum();
        let shares = walk_shares(&fit, &tree);
        assert_eq!(shares.len(), tree.len());
        assert!(shares[0] == 0.0);
        assert!((1..tree.len()).all(|walk| near(shares[walk], fit.score(walk).exp() / whole)));
        let best = best_walk(&fit, &tree).unwrap();
        assert!(best > 0 && (1..tree.len()).all(|walk| shares[walk] <= shares[best]));
    }
}

#[test]
fn walk_shares_are_nothing_where_no_walk_fits() {
    let building = make_corridor(&["hallway"; 12]);
    let guide = make_guide(vec![bare_step(GuideStepKind::Go)]);
    let start = WalkTree::single_walk(&building, &[3], 0.0);
    let fit = WalkFit::new(&GuideTrial::new(&guide, &building), &start, &random_weights(1));
    assert_eq!((walk_shares(&fit, &start), best_walk(&fit, &start)), (vec![0.0], None));
    let long = WalkTree::single_walk(&building, &(0..12).collect::<Vec<_>>(), 0.0);
    let fit = WalkFit::new(&GuideTrial::new(&guide, &building), &long, &random_weights(1));
    let shares = walk_shares(&fit, &long);
    assert!(shares[8] > 0.0 && shares[9..] == [0.0; 3]);
}

#[test]
fn a_higher_weight_of_a_walk_s_own_feature_raises_its_share() {
    let building = KnownBuilding::from_survey(&surveyed());
    let guide = Guide::read_text(TEXTS[0]);
    let tree = WalkTree::from_prior(&building, 0, 0.0, WalkPrior::Shortest(8));
    let trial = GuideTrial::new(&guide, &building);
    let weights = random_weights(2);
    let shares = |weights: &FeatureWeights| walk_shares(&WalkFit::new(&trial, &tree, weights), &tree);
    let endings = |walk| {
        let mut found = Vec::new();
        ending_features(&trial, &tree, walk, &mut found);
        found
    };
    let own: Vec<u32> = endings(1).into_iter().filter(|feature| !endings(2).contains(feature)).collect();
    assert!(!own.is_empty());
    let mut values = weights.values().to_vec();
    values[own[0] as usize] += 1.0;
    let (before, after) = (shares(&weights), shares(&FeatureWeights::from_values(&values)));
    assert!(after[1] > before[1] && after[2] < before[2]);
    assert!(near((after[1] / after[2]) / (before[1] / before[2]), 1.0f64.exp()));
}

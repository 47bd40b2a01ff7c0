use super::*;
use crate::{
    Guide, KnownBuilding, WalkPrior,
    made_buildings::{make_corridor, random_weights},
    tests::surveyed,
};

const TEXT: &str = "Walk down the hallway and turn right. Walk into the kitchen and wait by the oven.";
const WRONG: &str = "Walk down the hallway and turn left. Walk into the bedroom and wait by the oven.";

fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() < tolerance
}

/// Compares a gradient with differences of a loss, weight by weight, and returns how many weights matter.
fn compare_slope(slope: &[f64], weights: &FeatureWeights, loss: impl Fn(&FeatureWeights) -> f64) -> usize {
    const STEP: f64 = 1e-4;
    let mut count = 0;
    for at in 0..slope.len() {
        if slope[at] == 0.0 && at % 97 != 0 {
            continue;
        }
        let at_offset = |off: f64| {
            let mut values = weights.values().to_vec();
            values[at] += off;
            loss(&FeatureWeights::from_values(&values))
        };
        let expected = (at_offset(STEP) - at_offset(-STEP)) / (2.0 * STEP);
        assert!(near(slope[at], expected, 1e-4), "weight {at}: {} {expected}", slope[at]);
        count += usize::from(expected.abs() > 1e-3);
    }
    count
}

#[test]
fn add_text_is_the_derivative_of_the_loss_by_every_weight() {
    let building = KnownBuilding::from_survey(&surveyed());
    let guide = Guide::read_text(TEXT);
    let trial = GuideTrial::new(&guide, &building);
    let tree = WalkTree::from_prior(&building, 0, 0.0, WalkPrior::Shortest(8));
    let goal = tree.find_walk(&[0, 1, 2, 5, 6]).unwrap();
    let weights = random_weights(4);
    let loss = |weights: &FeatureWeights| -walk_shares(&WalkFit::new(&trial, &tree, weights), &tree)[goal].ln();
    let mut slope = FitSlope::default();
    slope.add_text(&trial, &tree, goal, &weights);
    assert!(near(slope.loss, loss(&weights), 1e-12));
    assert_eq!(slope.texts, 1);
    assert!(compare_slope(&slope.values, &weights, loss) > 60);
    // Another text adds up.
    slope.add_text(&trial, &tree, goal, &weights);
    assert!(near(slope.loss, 2.0 * loss(&weights), 1e-12) && slope.texts == 2);
}

#[test]
fn add_text_ignores_a_goal_that_no_step_leads_to() {
    let building = make_corridor(&["hallway"; 11]);
    let guide = Guide::read_text("Walk to the sofa.");
    let trial = GuideTrial::new(&guide, &building);
    let tree = WalkTree::single_walk(&building, &(0..11).collect::<Vec<_>>(), 0.0);
    let mut slope = FitSlope::default();
    slope.add_text(&trial, &tree, 10, &random_weights(4));
    slope.add_text(&trial, &tree, 0, &random_weights(4));
    assert!(slope.texts == 0 && slope.loss == 0.0 && slope.values.iter().all(|value| *value == 0.0));
    slope.add_text(&trial, &tree, 8, &random_weights(4));
    assert!(slope.texts == 1 && slope.loss > 0.0);
}

#[test]
fn add_empty_text_adds_the_slope_of_an_empty_text_without_its_loss() {
    let building = KnownBuilding::from_survey(&surveyed());
    let (guide, nothing) = (Guide::read_text(TEXT), Guide::read_text(""));
    let (trial, empty) = (GuideTrial::new(&guide, &building), GuideTrial::new(&nothing, &building));
    let tree = WalkTree::from_prior(&building, 0, 0.0, WalkPrior::Shortest(8));
    let weights = random_weights(5);
    let [mut text, mut floor, mut both] = [(); 3].map(|()| FitSlope::default());
    text.add_text(&trial, &tree, 3, &weights);
    floor.add_text(&empty, &tree, 3, &weights);
    both.add_text(&trial, &tree, 3, &weights);
    both.add_empty_text(&empty, &tree, 3, &weights);
    assert!(near(both.loss, text.loss, 1e-12) && both.texts == 1);
    assert!(floor.values.iter().any(|value| value.abs() > 0.1));
    let sums = text.values.iter().zip(&floor.values).map(|(a, b)| a + b);
    assert!(both.values.iter().zip(sums).all(|(a, b)| near(*a, b, 1e-12)));
}

#[test]
fn add_contrast_is_the_derivative_of_the_share_of_the_wrong_text() {
    let building = KnownBuilding::from_survey(&surveyed());
    let guides = [TEXT, WRONG].map(Guide::read_text);
    let [right, wrong] = guides.each_ref().map(|guide| GuideTrial::new(guide, &building));
    let walk = WalkTree::single_walk(&building, &[0, 1, 2, 5, 6], 0.0);
    let weights = random_weights(6);
    let loss = |weights: &FeatureWeights| {
        let [right, wrong] = [&right, &wrong].map(|trial| WalkFit::new(trial, &walk, weights).score(4));
        2.5 * (wrong - right).exp().ln_1p()
    };
    let mut slope = FitSlope::default();
    slope.add_contrast(&right, &wrong, &walk, &weights, 2.5);
    assert!(compare_slope(&slope.values, &weights, loss) > 15);
    assert!(slope.texts == 0 && slope.loss == 0.0);
    let long = make_corridor(&["hallway"; 11]);
    let tree = WalkTree::single_walk(&long, &(0..11).collect::<Vec<_>>(), 0.0);
    let short = Guide::read_text("Walk on.");
    let [few, more] = [&short, &guides[0]].map(|guide| GuideTrial::new(guide, &long));
    let mut slope = FitSlope::default();
    slope.add_contrast(&few, &more, &tree, &weights, 1.0);
    assert!(slope.values.iter().all(|value| *value == 0.0), "a text that cannot lead there has no share");
}

#[test]
fn plus_adds_slopes_losses_and_texts() {
    let mut a = FitSlope::default();
    a.values[3] = 1.0;
    a.loss = 2.0;
    a.texts = 3;
    let mut b = FitSlope::default();
    b.values[3] = 0.5;
    b.values[4] = -4.0;
    b.loss = 0.25;
    b.texts = 5;
    let sum = a.plus(&b);
    assert_eq!((sum.values[3], sum.values[4], sum.loss, sum.texts), (1.5, -4.0, 2.25, 8));
}

#[test]
fn step_down_follows_adam_with_a_pull_to_the_start() {
    let plan = FitPlan { rounds: 2, batch: 1, rate: 0.1, hold: 0.5, hold_fine: 1.0 };
    let mut descent = AdamDescent::new(plan, vec![1.0, -2.0], vec![0.5, 0.0]);
    // Worked out apart from this program, from the published formulas.
    let expected = [
        [0.900000049999975, -1.9000000333333222],
        [0.8537700745841568, -1.8799891136865476],
        [0.8314162202903814, -1.884003993569581],
    ];
    let steps = [(0, [4.0, -6.0], 2), (1, [1.0, 1.0], 0), (1, [-3.0, 8.0], 4)];
    for ((round, slope, examples), expected) in steps.into_iter().zip(expected) {
        descent.step_down(round, &slope, examples);
        assert!(descent.values.iter().zip(expected).all(|(a, b)| near(*a, b, 1e-12)), "{:?}", descent.values);
    }
    // The mean over the two steps of the last round.
    let finished = descent.finish();
    assert!((0..2).all(|at| near(finished[at], (expected[1][at] + expected[2][at]) / 2.0, 1e-12)));
}

#[test]
fn finish_before_the_last_round_gives_the_values_as_they_are() {
    let plan = FitPlan { rounds: 3, ..FitPlan::default() };
    let mut descent = AdamDescent::new(plan, vec![1.0], vec![0.0]);
    descent.step_down(0, &[1.0], 1);
    let values = descent.values.clone();
    assert_eq!(descent.finish(), values);
}

#[test]
fn hold_strengths_are_higher_for_fine_tables() {
    let plan = FitPlan { hold: 0.5, hold_fine: 4.0, ..FitPlan::default() };
    let holds = hold_strengths(plan, tables::ALL);
    assert_eq!(holds.len(), tables::COUNT);
    for table in tables::ALL {
        let expected = if table.is_fine { 2.0 } else { 0.5 };
        assert!(holds[table.from..table.from + table.size].iter().all(|hold| *hold == expected), "{}", table.name);
    }
}

#[test]
fn weight_learner_raises_the_share_of_the_known_walk() {
    let building = KnownBuilding::from_survey(&surveyed());
    let guide = Guide::read_text(WRONG);
    let trial = GuideTrial::new(&guide, &building);
    let tree = WalkTree::from_prior(&building, 0, 0.0, WalkPrior::Shortest(8));
    let goal = tree.find_walk(&[0, 7]).unwrap();
    let start = FeatureWeights::by_hand();
    let share = |weights: &FeatureWeights| walk_shares(&WalkFit::new(&trial, &tree, weights), &tree)[goal];
    let mut learner = WeightLearner::new(FitPlan { rounds: 5, ..FitPlan::default() }, &start);
    assert_eq!(learner.current_weights(), start);
    let mut last = share(&start);
    for round in 0..5 {
        let mut slope = FitSlope::default();
        slope.add_text(&trial, &tree, goal, &learner.current_weights());
        learner.step_down(round, &slope);
        let now = share(&learner.current_weights());
        assert!(now > last, "{now} {last}");
        last = now;
    }
    let weights = learner.current_weights();
    assert_eq!(learner.finish(), weights, "the last round has one step");
}

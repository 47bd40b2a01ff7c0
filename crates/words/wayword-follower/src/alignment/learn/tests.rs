use super::*;
use crate::{
    alignment::{
        PartedText,
        tests::{TEXT, corner, dense_corner, random_alignment_weights, read_parted, whole_walk},
    },
    made_buildings::random_weights,
};

/// The stretches of the three parts of [`TEXT`] on the walk around the corner.
const KNOWN: [[usize; 2]; 3] = [[0, 3], [3, 4], [4, 5]];

fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() < tolerance
}

fn slope_of(case: &AlignmentCase<'_>, known: &[[usize; 2]], weights: &AlignmentWeights) -> AlignmentSlope {
    let mut slope = AlignmentSlope::default();
    slope.add_text(case, known, weights);
    slope
}

fn corner_case(text: &PartedText) -> AlignmentCase<'_> {
    whole_walk(text, &corner(), 0.0, &random_weights(2))
}

#[test]
fn add_text_is_the_derivative_of_the_loss() {
    const STEP: f64 = 1e-4;
    let text = read_parted(TEXT);
    let case = corner_case(&text);
    for reading in [PartReading::Words, PartReading::WordCounts] {
        let mut weights = random_alignment_weights(3, reading, 0.3);
        // The follower's scores are large numbers.
        weights.values[tables::FOLLOWER.from] = 0.05;
        let slope = slope_of(&case, &KNOWN, &weights);
        let mut count = 0;
        for at in 0..tables::COUNT {
            // Every weight that counts, and some of the others.
            if slope.values[at] == 0.0 && at % 97 != 0 {
                continue;
            }
            let loss_at = |off: f64| {
                let mut moved = weights.clone();
                moved.values[at] += off;
                slope_of(&case, &KNOWN, &moved).loss
            };
            let expected = (loss_at(STEP) - loss_at(-STEP)) / (2.0 * STEP);
            assert!(near(slope.values[at], expected, 2e-4), "weight {at}: {} {expected}", slope.values[at]);
            count += usize::from(expected.abs() > 1e-3);
        }
        assert!(count > 30, "{reading:?}: {count}");
    }
}

#[test]
fn loss_is_the_negative_log_of_the_share_of_the_known_cut() {
    let text = read_parted(TEXT);
    for reading in [PartReading::Words, PartReading::WordCounts] {
        let slope = slope_of(&corner_case(&text), &KNOWN, &AlignmentWeights::all_zero(reading));
        assert!(near(slope.loss, 21.0f64.ln(), 1e-9), "there are 21 ways to cut: {}", slope.loss);
    }
    // With two parts the end of the first is the whole cut.
    let text = read_parted("Turn right. Stop at the lamp.");
    let case = corner_case(&text);
    let weights = random_alignment_weights(5, PartReading::Words, 0.3);
    let shares = case.align_parts(&weights).parts.swap_remove(0).end_shares;
    for (end, share) in shares.iter().enumerate() {
        let loss = slope_of(&case, &[[0, end], [end, 5]], &weights).loss;
        assert!(near(loss, -share.ln(), 1e-9), "{end}: {loss} {share}");
    }
}

#[test]
fn word_counts_teach_nothing_about_words() {
    let text = read_parted(TEXT);
    let case = corner_case(&text);
    let slope = slope_of(&case, &KNOWN, &random_alignment_weights(3, PartReading::WordCounts, 0.3));
    // The tables of what the words ask for follow those of lengths.
    let (lengths, words) = slope.values.split_at(tables::KIND_HOPS.from);
    assert!(lengths.iter().any(|value| value.abs() > 0.01) && words.iter().all(|value| *value == 0.0));
    let slope = slope_of(&case, &KNOWN, &random_alignment_weights(3, PartReading::Words, 0.3));
    assert!(slope.values[tables::KIND_HOPS.from..].iter().any(|value| value.abs() > 0.01));
}

#[test]
fn known_ends_on_a_dense_walk_count_as_the_next_place() {
    let text = read_parted(TEXT);
    let case = whole_walk(&text, &dense_corner(), 0.0, &random_weights(2));
    let weights = random_alignment_weights(6, PartReading::Words, 0.3);
    let loss =
        |first: usize, second: usize| slope_of(&case, &[[0, first], [first, second], [second, 17]], &weights).loss;
    // The places are 0, 4, 6, 10, 14 and 17.
    assert!(near(loss(5, 9), loss(6, 10), 1e-12));
    assert!(near(loss(1, 16), loss(4, 17), 1e-12));
    assert!(!near(loss(4, 10), loss(6, 10), 1e-6));
}

#[test]
fn plus_adds_slopes_losses_and_texts() {
    let text = read_parted(TEXT);
    let case = corner_case(&text);
    let weights = random_alignment_weights(7, PartReading::Words, 0.3);
    let [a, b] = [KNOWN, [[0, 1], [1, 1], [1, 5]]].map(|known| slope_of(&case, &known, &weights));
    let sum = a.clone().plus(&b);
    assert!(near(sum.loss, a.loss + b.loss, 1e-12) && sum.texts == 2);
    assert!((0..tables::COUNT).all(|at| near(sum.values[at], a.values[at] + b.values[at], 1e-12)));
    let mut both = slope_of(&case, &KNOWN, &weights);
    both.add_text(&case, &[[0, 1], [1, 1], [1, 5]], &weights);
    assert!(near(both.loss, sum.loss, 1e-12) && both.texts == 2);
}

#[test]
fn alignment_learner_finds_the_known_cut() {
    let text = read_parted(TEXT);
    let case = corner_case(&text);
    for reading in [PartReading::Words, PartReading::WordCounts] {
        let plan = FitPlan { rounds: 20, ..FitPlan::default() };
        let mut learner = AlignmentLearner::new(plan, reading);
        assert_eq!(learner.current_weights(), AlignmentWeights::all_zero(reading));
        let first = slope_of(&case, &KNOWN, &learner.current_weights()).loss;
        for round in 0..20 {
            let slope = slope_of(&case, &KNOWN, &learner.current_weights());
            learner.step_down(round, &slope);
        }
        let weights = learner.current_weights();
        let last = slope_of(&case, &KNOWN, &weights).loss;
        assert!(last < 0.5 * first, "{reading:?}: {first} {last}");
        let found: Vec<[usize; 2]> = case.align_parts(&weights).parts.iter().map(|part| part.stretch).collect();
        assert_eq!(found, KNOWN, "{reading:?}");
        assert_eq!(learner.finish(), weights, "the last round has one step");
    }
}

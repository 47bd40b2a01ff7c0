//! Simulates choices between the texts of three systems, and the intervals of the strengths that a Bradley-Terry model gives them.

use super::CONFIDENCE_LEVEL;
use super::assignment::{AnswerSlot, STUDY_ITEM_COUNT};
use super::logits::{draw_normals, mean_over_normal};
use rand::Rng;
use std::f64::consts::SQRT_2;
use wayword_metrics::{BradleyTerry, ConfidenceInterval, FittedTerm, PairPreference, SystemComparison, bradley_terry};

/// How good the texts of each system are, as the logarithm of the odds to be chosen.
const SYSTEM_UTILITIES: [f64; SYSTEM_COUNT] = [0.6, 0.0, -0.6];
/// The number of systems.
const SYSTEM_COUNT: usize = 3;
/// The advantage of the text that is shown first, on the same scale.
const SIDE_ADVANTAGE: f64 = 0.2;
/// How likely a tie is between equal texts, on the same scale: the logarithm of the parameter in Davidson's model of ties.
const TIE_PARAMETER: f64 = -0.5;

/// The number of choices of each ordered pair from which the true strengths are computed.
const CHOICES_PER_ORDERED_PAIR: f64 = 5000.0;

/// The intervals of the strengths that simulated choices give; none where they give no strengths.
///
/// A person, and an item, gives each system a part of its utility, so that differences have standard deviation `sd`.
pub(super) fn strength_intervals(slots: &[AnswerSlot], sd: f64, rng: &mut impl Rng) -> Vec<ConfidenceInterval> {
    let part = sd / SQRT_2;
    let (persons, items) =
        (draw_normals(SYSTEM_COUNT * slots.len(), part, rng), draw_normals(SYSTEM_COUNT * STUDY_ITEM_COUNT, part, rng));
    let choose = |slot: &AnswerSlot| {
        let AnswerSlot { person, item, .. } = *slot;
        let first = rng.random_range(0..SYSTEM_COUNT);
        let second = (first + rng.random_range(1..SYSTEM_COUNT)) % SYSTEM_COUNT;
        let utility = |system: usize| {
            SYSTEM_UTILITIES[system] + persons[SYSTEM_COUNT * person + system] + items[SYSTEM_COUNT * item + system]
        };
        let [won, lost, _] = choice_chances(utility(first) - utility(second));
        let chance: f64 = rng.random();
        let preference = match () {
            () if chance < won => PairPreference::First,
            () if chance < won + lost => PairPreference::Second,
            () => PairPreference::Tie,
        };
        SystemComparison { person, item, first, second, preference }
    };
    let choices: Vec<_> = slots.iter().map(choose).collect();
    fit_strengths(&choices).iter().map(|term| term.interval).collect()
}

/// The true strengths over all persons and items: those of a data set in which each choice occurs as often as expected. They are nearer
/// to each other than any one person's utilities, because persons disagree.
pub(super) fn true_strengths(sd: f64) -> Vec<f64> {
    let mut choices = Vec::new();
    for (first, second) in [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)] {
        let better = SYSTEM_UTILITIES[first] - SYSTEM_UTILITIES[second];
        for (at, preference) in
            [PairPreference::First, PairPreference::Second, PairPreference::Tie].into_iter().enumerate()
        {
            let expected =
                CHOICES_PER_ORDERED_PAIR * mean_over_normal(better, sd * SQRT_2, |better| choice_chances(better)[at]);
            for _ in 0..expected.round() as usize {
                // Each choice is another person's about another item: one item alone would give no strengths.
                let number = choices.len();
                choices.push(SystemComparison { person: number, item: number, first, second, preference });
            }
        }
    }
    fit_strengths(&choices).iter().map(|term| term.value).collect()
}

/// The chances that the first is chosen, the second, or neither, by how much better the first is.
fn choice_chances(better: f64) -> [f64; 3] {
    let odds = [better + SIDE_ADVANTAGE, 0.0, TIE_PARAMETER + (better + SIDE_ADVANTAGE) / 2.0].map(libm::exp);
    let all: f64 = odds.iter().sum();
    odds.map(|chosen| chosen / all)
}

/// The strengths in the order of the systems, where all of them have one.
fn fit_strengths(choices: &[SystemComparison<usize, usize, usize>]) -> Vec<FittedTerm> {
    let Ok(BradleyTerry { mut strengths, .. }) = bradley_terry(choices, CONFIDENCE_LEVEL) else { return Vec::new() };
    strengths.sort_by_key(|strength| strength.system);
    if strengths.len() == SYSTEM_COUNT { strengths.iter().map(|strength| strength.term).collect() } else { Vec::new() }
}

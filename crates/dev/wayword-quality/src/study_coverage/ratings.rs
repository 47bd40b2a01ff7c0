//! Simulates ratings on five levels, and the interval of Krippendorff's alpha, which measures how far persons agree.

use super::CONFIDENCE_LEVEL;
use super::assignment::{AnswerSlot, STUDY_ITEM_COUNT};
use super::logits::{draw_normals, expit, mean_over_normal};
use rand::Rng;
use wayword_metrics::{AnswerScale, ConfidenceInterval, StudyAnswer, krippendorff_alpha};

/// The four bounds between the five levels, on the logit scale.
const LEVEL_CUTS_LOGITS: [f64; 4] = [-2.0, -0.7, 0.7, 2.0];
/// The number of levels.
const LEVEL_COUNT: usize = LEVEL_CUTS_LOGITS.len() + 1;

/// The interval of alpha that simulated ratings give.
pub(super) fn alpha_interval(slots: &[AnswerSlot], sd: f64, rng: &mut impl Rng) -> Option<ConfidenceInterval> {
    let (persons, items) = (draw_normals(slots.len(), sd, rng), draw_normals(STUDY_ITEM_COUNT, sd, rng));
    let rate = |slot: &AnswerSlot| {
        let chance: f64 = rng.random();
        let noise = libm::log(chance / (1.0 - chance));
        let felt = persons[slot.person] + items[slot.item] + noise;
        let level = LEVEL_CUTS_LOGITS.iter().filter(|cut| felt > **cut).count();
        StudyAnswer { person: slot.person, item: slot.item, value: level as f64 }
    };
    let answers: Vec<_> = slots.iter().map(rate).collect();
    krippendorff_alpha(&answers, AnswerScale::Ordinal, CONFIDENCE_LEVEL)?.interval
}

/// The true alpha over all persons and items: one minus the expected disagreement of two persons about one item, divided by that of two
/// answers to any items.
pub(super) fn true_alpha(sd: f64) -> f64 {
    let chance = |level: usize, item: f64| chance_above(level, item, sd) - chance_above(level + 1, item, sd);
    let overall: Vec<f64> =
        (0..LEVEL_COUNT).map(|level| mean_over_normal(0.0, sd, |item| chance(level, item))).collect();
    // On an ordinal scale, a level lies at the share of answers below it and half of its own.
    let place = |level: usize| overall[..level].iter().sum::<f64>() + overall[level] / 2.0;
    let disagreement = |chance_of: &dyn Fn(usize, usize) -> f64| -> f64 {
        let pairs = (0..LEVEL_COUNT).flat_map(|a| (0..LEVEL_COUNT).map(move |b| (a, b)));
        pairs.map(|(a, b)| chance_of(a, b) * (place(a) - place(b)).powi(2)).sum()
    };
    let observed = disagreement(&|a, b| mean_over_normal(0.0, sd, |item| chance(a, item) * chance(b, item)));
    1.0 - observed / disagreement(&|a, b| overall[a] * overall[b])
}

/// The chance that a person rates an item at a level or above it.
fn chance_above(level: usize, item: f64, sd: f64) -> f64 {
    match level.checked_sub(1).map(|cut| LEVEL_CUTS_LOGITS.get(cut)) {
        None => 1.0,
        Some(None) => 0.0,
        Some(Some(cut)) => mean_over_normal(item - cut, sd, expit),
    }
}

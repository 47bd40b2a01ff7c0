//! Simulates ratings on five levels, and the interval of Krippendorff's alpha, which measures how far persons agree.

use super::assigned::{ITEMS, Slot};
use super::figure::LEVEL;
use super::logits::{expit, normals, over};
use rand::Rng;
use wayword_metrics::{Answer, Interval, Scale, agreement};

/// The four bounds between the five levels, on the logit scale.
const CUTS: [f64; 4] = [-2.0, -0.7, 0.7, 2.0];
const LEVELS: usize = CUTS.len() + 1;

/// The interval of alpha that simulated ratings give.
pub(super) fn interval(slots: &[Slot], sd: f64, rng: &mut impl Rng) -> Option<Interval> {
    let (persons, items) = (normals(slots.len(), sd, rng), normals(ITEMS, sd, rng));
    let rate = |slot: &Slot| {
        let chance: f64 = rng.random();
        let noise = libm::log(chance / (1.0 - chance));
        let felt = persons[slot.person] + items[slot.item] + noise;
        let level = CUTS.iter().filter(|cut| felt > **cut).count();
        Answer { person: slot.person, item: slot.item, value: level as f64 }
    };
    let given: Vec<_> = slots.iter().map(rate).collect();
    agreement(&given, Scale::Ordinal, LEVEL)?.interval
}

/// The true alpha over all persons and items: one minus the expected disagreement of two persons about one item, divided by that of two
/// answers to any items.
pub(super) fn alpha(sd: f64) -> f64 {
    let chance = |level: usize, item: f64| above(level, item, sd) - above(level + 1, item, sd);
    let overall: Vec<f64> = (0..LEVELS).map(|level| over(0.0, sd, |item| chance(level, item))).collect();
    let place = |level: usize| overall[..level].iter().sum::<f64>() + overall[level] / 2.0;
    let disagreement = |chance_of: &dyn Fn(usize, usize) -> f64| -> f64 {
        let pairs = (0..LEVELS).flat_map(|a| (0..LEVELS).map(move |b| (a, b)));
        pairs.map(|(a, b)| chance_of(a, b) * (place(a) - place(b)).powi(2)).sum()
    };
    let observed = disagreement(&|a, b| over(0.0, sd, |item| chance(a, item) * chance(b, item)));
    1.0 - observed / disagreement(&|a, b| overall[a] * overall[b])
}

/// The chance that a person rates an item at a level or above it.
fn above(level: usize, item: f64, sd: f64) -> f64 {
    match level.checked_sub(1).map(|cut| CUTS.get(cut)) {
        None => 1.0,
        Some(None) => 0.0,
        Some(Some(cut)) => over(item - cut, sd, expit),
    }
}

//! The weights of the features, and the chance that a pair is wrong.

use super::{JudgedPair, PairMotion};
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, sync::LazyLock};

/// The weights of a score of pairs.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairWeights {
    /// The data that they were fitted to.
    pub origin: String,
    /// The command that fits them.
    pub command: String,
    /// For each source of motion and each feature, what the feature adds to the logarithm of the odds that the pair is wrong, where half of
    /// all pairs are.
    pub weights: BTreeMap<PairMotion, BTreeMap<String, f64>>,
}

/// Why a file of weights cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PairWeightsError {
    /// It is not JSON of this kind.
    #[error("it does not hold weights: {0}")]
    Json(#[from] serde_json::Error),
}

static BY_PICTURES: LazyLock<PairWeights> = LazyLock::new(|| shipped(include_str!("by_pictures.json")));
static BY_LABELS: LazyLock<PairWeights> = LazyLock::new(|| shipped(include_str!("by_labels.json")));

/// A file that ships with the program; a test reads each.
fn shipped(text: &str) -> PairWeights {
    PairWeights::parse(text).unwrap_or_default()
}

/// Which eye looked: the weights for each were fitted to pairs that such an eye saw.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairEye {
    /// A model or a detector, in pictures along the walk.
    Pictures,
    /// The labels of a dataset, around each viewpoint.
    Labels,
}

impl PairWeights {
    /// Reads a file of weights.
    ///
    /// # Errors
    /// When it is not one.
    pub fn parse(text: &str) -> Result<Self, PairWeightsError> {
        Ok(serde_json::from_str(text)?)
    }

    /// The weights that ship with the program for an eye.
    #[must_use]
    pub fn for_eye(eye: PairEye) -> &'static Self {
        match eye {
            PairEye::Pictures => &BY_PICTURES,
            PairEye::Labels => &BY_LABELS,
        }
    }

    /// The chance that a pair is wrong, where this share of all pairs is.
    #[must_use]
    pub fn chance_wrong(&self, pair: &JudgedPair, base_rate: f64) -> f64 {
        let rate = base_rate.clamp(MIN_RATE, 1.0 - MIN_RATE);
        let weights = self.weights.get(&pair.motion);
        let weight = |(name, value): &(String, f64)| {
            weights.and_then(|known| known.get(name)).copied().unwrap_or_default() * value
        };
        let odds = pair.features.iter().map(weight).sum::<f64>() + (rate / (1.0 - rate)).ln();
        1.0 / (1.0 + (-odds).exp())
    }
}

/// The same chances, moved together until their weighted mean is a share: by one summand of the logarithms of their odds, so that no order
/// changes. `weighted` has chances with their weights.
#[must_use]
pub fn chances_with_mean(weighted: &[(f64, f64)], share: f64) -> Vec<f64> {
    let moved = |summand: f64, chance: f64| {
        let odds = (chance / (1.0 - chance)).ln() + summand;
        1.0 / (1.0 + (-odds).exp())
    };
    let whole: f64 = weighted.iter().map(|(_, weight)| weight).sum();
    let mean = |summand: f64| {
        let sum: f64 = weighted.iter().map(|(chance, weight)| moved(summand, *chance) * weight).sum();
        sum / whole.max(f64::MIN_POSITIVE)
    };
    let (mut low, mut high) = (-MAX_SUMMAND, MAX_SUMMAND);
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if mean(middle) < share { low = middle } else { high = middle }
    }
    weighted.iter().map(|(chance, _)| moved(low, *chance)).collect()
}

/// Chances are moved by this at most, logarithm of odds.
const MAX_SUMMAND: f64 = 12.0;
/// The smallest share of wrong pairs that counts, and the smallest share of right ones.
const MIN_RATE: f64 = 1e-3;

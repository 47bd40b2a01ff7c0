//! The weights of the features.

mod by_hand;
mod file;

use crate::features::{FeatureNumber, tables};
pub use file::WeightsError;
use std::sync::LazyLock;

/// The weight of each feature for or against a walk, in natural logs.
#[derive(Debug, Clone, PartialEq)]
pub struct FeatureWeights(Vec<f64>);

static FITTED_WEIGHTS: LazyLock<FeatureWeights> =
    LazyLock::new(|| FeatureWeights::parse(include_str!("fitted.json")).unwrap_or_else(|_| FeatureWeights::by_hand()));

impl FeatureWeights {
    /// The weights that the program uses: fitted to people's texts, as documented in their file.
    #[must_use]
    pub fn fitted() -> &'static Self {
        &FITTED_WEIGHTS
    }

    /// Weights written by hand from the meaning of the words.
    #[must_use]
    pub fn by_hand() -> Self {
        by_hand::weights_by_hand()
    }

    /// The sum of the weights of these features.
    pub(crate) fn sum_of(&self, found: &[FeatureNumber]) -> f64 {
        found.iter().map(|feature| self.0[*feature as usize]).sum()
    }

    /// Weights of 0.
    #[must_use]
    pub(crate) fn all_zero() -> Self {
        Self(vec![0.0; tables::COUNT])
    }

    /// The weights, by the features' numbers.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.0
    }

    pub(crate) fn from_values(values: &[f64]) -> Self {
        Self(values.to_vec())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_of_weights_can_be_read() {
        assert!(FeatureWeights::parse(include_str!("fitted.json")).is_ok());
    }

    #[test]
    fn weights_survive_their_file() {
        let weights = FeatureWeights::by_hand();
        let again = FeatureWeights::parse(&weights.to_json("by hand", "none")).unwrap();
        let off = weights.values().iter().zip(again.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 0.001, "{off}");
    }
}

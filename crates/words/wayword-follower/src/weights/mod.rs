//! The weights of the features.

mod by_hand;
mod file;

use crate::features::{FeatureNumber, tables};
pub use file::WeightsError;
pub(crate) use file::{lists_by_table, weights_by_table, write_tables};
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
    pub(crate) fn sum_weights(&self, found: &[FeatureNumber]) -> f64 {
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

    /// The weights from a list in the order of the features' numbers.
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

    #[test]
    fn parse_refuses_a_table_of_the_wrong_size_or_without_numbers() {
        let text = FeatureWeights::by_hand().to_json("by hand", "none");
        let longer = text.replace("\"UNTOLD_LENGTH\":[", "\"UNTOLD_LENGTH\":[1.0,");
        let missing = text.replace("UNTOLD_LENGTH", "UNTOLD_WIDTH");
        for (text, count) in [(longer, 9), (missing, 0)] {
            let error = FeatureWeights::parse(&text).unwrap_err();
            let WeightsError::Table { table, found, needed } = error else { panic!("{error}") };
            assert_eq!((table, found, needed), ("UNTOLD_LENGTH", count, 8));
        }
        assert!(matches!(FeatureWeights::parse("{}"), Err(WeightsError::Json(_))));
    }

    #[test]
    fn to_json_rounds_to_thousandths_and_names_the_origin() {
        let mut values = vec![0.0; tables::COUNT];
        values[0] = 1.23456;
        values[1] = -0.0016;
        let text = FeatureWeights::from_values(&values).to_json("some data", "some command");
        assert!(text.contains("\"origin\":\"some data\",\"command\":\"some command\"") && text.ends_with("}\n"));
        assert!(text.contains("\n\"HOPS\":[1.235,-0.002,0.0,") && !text.contains("going") && !text.contains("away"));
        assert_eq!(FeatureWeights::parse(&text).unwrap().values()[..3], [1.235, -0.002, 0.0]);
    }

    #[test]
    fn sum_weights_adds_the_weights_of_features() {
        let mut values = vec![0.0; tables::COUNT];
        values[3] = 1.5;
        values[7] = -4.0;
        let weights = FeatureWeights::from_values(&values);
        assert_eq!(
            [weights.sum_weights(&[]), weights.sum_weights(&[3, 3]), weights.sum_weights(&[3, 7, 1])],
            [0.0, 3.0, -2.5]
        );
        assert!(FeatureWeights::all_zero().values().iter().all(|weight| *weight == 0.0));
    }

    #[test]
    fn fitted_weights_are_those_of_the_file() {
        let file = FeatureWeights::parse(include_str!("fitted.json")).unwrap();
        assert!(*FeatureWeights::fitted() == file && file != FeatureWeights::by_hand());
    }
}

//! The weights of the features of parts, and their file.

use super::{features::ValuedFeature, tables};
use crate::weights::{WeightsError, lists_by_table, weights_by_table, write_tables};
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, sync::LazyLock};

/// What an alignment may know of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PartReading {
    /// All its words.
    Words,
    /// Only how many words it has. This is the baseline that shows what reading gains.
    WordCounts,
}

/// The weight of each feature for or against a stretch, in natural logs.
#[derive(Debug, Clone, PartialEq)]
pub struct AlignmentWeights {
    pub(super) reading: PartReading,
    pub(super) values: Vec<f64>,
}

/// The content of a file of weights.
#[derive(Serialize, Deserialize)]
struct AlignmentFile {
    /// The data that the weights were fitted to.
    origin: String,
    /// The command that fits them.
    command: String,
    /// The weights of each table, for [`PartReading::Words`].
    words: BTreeMap<String, Vec<f64>>,
    /// The same for [`PartReading::WordCounts`].
    word_counts: BTreeMap<String, Vec<f64>>,
}

/// The shipped weights, in the order of [`PartReading`].
static FITTED_WEIGHTS: LazyLock<[AlignmentWeights; 2]> = LazyLock::new(|| {
    let nothing = || [PartReading::Words, PartReading::WordCounts].map(AlignmentWeights::all_zero);
    AlignmentWeights::parse(include_str!("fitted.json")).unwrap_or_else(|_| nothing())
});

impl AlignmentWeights {
    /// The weights that the program uses: fitted to people's stretches, as documented in their file.
    #[must_use]
    pub fn fitted(reading: PartReading) -> &'static Self {
        &FITTED_WEIGHTS[reading as usize]
    }

    /// Weights of 0: all cuts are equally likely.
    #[must_use]
    pub fn all_zero(reading: PartReading) -> Self {
        Self { reading, values: vec![0.0; tables::COUNT] }
    }

    /// The sum of the weights of these features, each times its value.
    pub(super) fn sum_weights(&self, found: &[ValuedFeature]) -> f64 {
        found.iter().map(|(feature, value)| self.values[*feature as usize] * value).sum()
    }

    /// Reads a file of weights: those for all words, and those for word counts.
    ///
    /// # Errors
    /// When a table is missing or has the wrong size.
    pub fn parse(text: &str) -> Result<[Self; 2], WeightsError> {
        let file: AlignmentFile = serde_json::from_str(text)?;
        let values = |lists| weights_by_table(tables::ALL, lists);
        Ok([
            Self { reading: PartReading::Words, values: values(&file.words)? },
            Self { reading: PartReading::WordCounts, values: values(&file.word_counts)? },
        ])
    }

    /// Both sets of weights as a file, rounded to thousandths. `origin` names the data of the fit, `command` how it was run.
    #[must_use]
    pub fn to_json(words: &Self, word_counts: &Self, origin: &str, command: &str) -> String {
        write_tables(&AlignmentFile {
            origin: origin.into(),
            command: command.into(),
            words: lists_by_table(tables::ALL, &words.values),
            word_counts: lists_by_table(tables::ALL, &word_counts.values),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::alignment::tests::random_alignment_weights;

    /// A file of weights without any pattern, and what it was written from.
    fn random_file() -> ([AlignmentWeights; 2], String) {
        let weights = [(1, PartReading::Words), (2, PartReading::WordCounts)]
            .map(|(seed, reading)| random_alignment_weights(seed, reading, 5.0));
        let text = AlignmentWeights::to_json(&weights[0], &weights[1], "some data", "some command");
        (weights, text)
    }

    #[test]
    fn the_file_of_weights_can_be_read() {
        let file = AlignmentWeights::parse(include_str!("fitted.json")).unwrap();
        for weights in file {
            assert!(*AlignmentWeights::fitted(weights.reading) == weights);
            assert!(weights != AlignmentWeights::all_zero(weights.reading));
        }
    }

    #[test]
    fn weights_survive_their_file() {
        let (weights, text) = random_file();
        for (before, after) in weights.iter().zip(AlignmentWeights::parse(&text).unwrap()) {
            assert_eq!((before.reading, before.values.len()), (after.reading, after.values.len()));
            let off = before.values.iter().zip(&after.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 0.001, "{off}");
        }
        assert!(text.contains("\"origin\":\"some data\",\"command\":\"some command\"") && text.ends_with("}\n"));
    }

    #[test]
    fn parse_refuses_a_table_that_is_missing_or_of_the_wrong_size() {
        let (_, text) = random_file();
        let refused = |text: &str| {
            let error = AlignmentWeights::parse(text).unwrap_err();
            let WeightsError::Table { table, found, needed } = error else { panic!("{error}") };
            (table, found, needed)
        };
        // In the weights for all words, and in those for word counts.
        let name = "\"CLIMB_RISE\":[";
        let places = [text.find(name).unwrap(), text.rfind(name).unwrap()];
        assert!(places[0] < places[1]);
        for at in places {
            let changed = |to: &str| format!("{}{to}{}", &text[..at], &text[at + name.len()..]);
            assert_eq!(refused(&changed("\"CLIMB_FALL\":[")), ("CLIMB_RISE", 0, tables::RISES));
            assert_eq!(refused(&changed("\"CLIMB_RISE\":[1.0,")), ("CLIMB_RISE", tables::RISES + 1, tables::RISES));
        }
        for text in ["{}", "[]", "", &text.replace("\"word_counts\"", "\"counts\"")] {
            assert!(matches!(AlignmentWeights::parse(text), Err(WeightsError::Json(_))), "{text}");
        }
    }

    #[test]
    fn sum_weights_multiplies_by_the_values() {
        let mut weights = AlignmentWeights::all_zero(PartReading::Words);
        weights.values[3] = 1.5;
        weights.values[7] = -4.0;
        assert_eq!(weights.sum_weights(&[]), 0.0);
        assert_eq!(weights.sum_weights(&[(3, 1.0), (7, 0.5), (1, 9.0)]), -0.5);
    }
}

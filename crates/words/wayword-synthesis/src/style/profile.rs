//! Measures the reference texts of a style: lengths, turns, wording. The rules writer takes its parameters from here.

use super::{measure::measure, way::Way, wording::Wording};
use serde::Serialize;
use std::{collections::BTreeSet, sync::Arc};
use wayword_checks::Copies;
use wayword_core::Style;
use wayword_language::{
    reading::{What, read},
    text::{sentence_count, word_count},
};

/// Measured on reference texts; shares are of texts, from 0 to 1.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Profile {
    /// Words of the texts, sorted: the writer draws its length from these.
    pub words: Vec<usize>,
    /// Sentences of the texts, sorted.
    pub sentences: Vec<usize>,
    /// Turn words per text.
    pub turns: f64,
    /// Landmarks and rooms per text.
    pub places: f64,
    /// Share that ends in a task.
    pub tasks: f64,
    /// Share that names a floor, or contains "upstairs" or "downstairs".
    pub floors: f64,
    /// Share that ends in a full stop.
    pub full_stops: f64,
    /// How they describe a way.
    #[serde(skip)]
    pub way: Way,
    /// How they word a place and a task.
    pub wording: Wording,
    /// The runs of words that no text may copy.
    #[serde(skip)]
    pub copies: Arc<Copies>,
}

impl Profile {
    /// Measures the references of a style. Numbers that the style gives itself take precedence.
    #[must_use]
    pub fn of(style: &Style) -> Self {
        let mut profile = Self::measure(&style.references);
        if !style.words.is_empty() {
            profile.words.clone_from(&style.words);
        }
        profile.wording.choose(style.choice);
        profile
    }

    /// Measures texts; texts without words are ignored.
    #[must_use]
    pub fn measure(references: &[String]) -> Self {
        let texts: Vec<&String> = references.iter().filter(|text| word_count(text) > 0).collect();
        let readings: Vec<_> = texts.iter().map(|text| read(text, &BTreeSet::new())).collect();
        let count = texts.len().max(1) as f64;
        let share = |holds: &dyn Fn(usize) -> bool| (0..texts.len()).filter(|at| holds(*at)).count() as f64 / count;
        let events = |is: &dyn Fn(&What) -> bool| {
            readings.iter().flat_map(|reading| &reading.events).filter(|event| is(&event.what)).count() as f64 / count
        };
        let sorted = |measure: &dyn Fn(&str) -> usize| {
            let mut values: Vec<usize> = texts.iter().map(|text| measure(text)).collect();
            values.sort_unstable();
            values
        };
        Self {
            words: sorted(&word_count),
            sentences: sorted(&sentence_count),
            turns: events(&|what| matches!(what, What::Turn(_))),
            places: events(&|what| matches!(what, What::Place(_))),
            tasks: share(&|at| readings[at].task.is_some()),
            floors: share(&|at| readings[at].events.iter().any(|event| matches!(event.what, What::Floor(_)))),
            full_stops: share(&|at| texts[at].trim_end().ends_with(['.', '!'])),
            way: Way::measure(texts.iter().map(|text| text.as_str()).zip(&readings)),
            wording: measure(texts.iter().map(|text| text.as_str()).zip(&readings)),
            copies: Arc::new(Copies::of(references)),
        }
    }

    /// Whether the texts describe the way turn by turn.
    #[must_use]
    pub fn tells_turns(&self) -> bool {
        self.turns >= 0.4
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::style::built_in;

    #[test]
    fn explicit_lengths_of_a_style_override_its_references() {
        let style = Style { words: vec![5, 7], ..built_in("r2r").unwrap() };
        assert_eq!(Profile::of(&style).words, [5, 7]);
        let style = built_in("r2r").unwrap();
        assert_eq!(Profile::of(&style).words, Profile::measure(&style.references).words);
    }

    #[test]
    fn from_references_separates_the_coarse_and_the_fine_style() {
        let coarse = Profile::measure(&built_in("reverie").unwrap().references);
        assert!(
            !coarse.tells_turns() && coarse.tasks > 0.8 && coarse.sentences.iter().all(|count| *count == 1),
            "{coarse:?}"
        );
        let fine = Profile::measure(&built_in("r2r").unwrap().references);
        assert!(fine.tells_turns() && fine.tasks == 0.0 && fine.full_stops == 1.0, "{fine:?}");
    }
}

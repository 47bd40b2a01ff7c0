//! Measures the reference texts of a style: lengths, turns, wording. The rules writer takes its parameters from here. Texts of another
//! language are measured through their English words.

use super::{
    language::{LanguageWording, learn_wording},
    measure::measure_wording,
    way::WayWording,
    wording::PlaceWording,
};
use serde::Serialize;
use std::{collections::BTreeSet, sync::Arc};
use wayword_checks::ReferenceRuns;
use wayword_core::InstructionStyle;
use wayword_language::{
    languages::ReadableText,
    reading::{EventContent, TextReading, read_instruction},
    text::word_count,
};

/// Properties that were measured on the reference texts of a style; shares are of texts, from 0 to 1.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StyleProfile {
    /// Words of the texts, sorted: the writer draws its length from these. For a text in another language, as many English words as say the
    /// same.
    pub words: Vec<usize>,
    /// Sentences of the texts, sorted.
    pub sentences: Vec<usize>,
    /// Turn words per text.
    pub turns: f64,
    /// Landmarks and rooms per text.
    pub places: f64,
    /// Share of texts that end in a task.
    pub tasks: f64,
    /// Share of texts that name a floor, or contain "upstairs" or "downstairs".
    pub floors: f64,
    /// Share of texts that end in a full stop.
    pub full_stops: f64,
    /// How they describe a way.
    #[serde(skip)]
    pub way: WayWording,
    /// How texts in the language of the style say it; `None` for English.
    #[serde(skip)]
    pub language: Option<LanguageWording>,
    /// How they word a place and a task.
    pub wording: PlaceWording,
    /// The runs of words that no text may copy.
    #[serde(skip)]
    pub copies: Arc<ReferenceRuns>,
}

impl StyleProfile {
    /// Measures the references of a style. Numbers that the style gives itself take precedence.
    #[must_use]
    pub fn for_style(style: &InstructionStyle) -> Self {
        let mut profile = Self::in_language(&style.references, &style.language);
        if !style.words.is_empty() {
            profile.words.clone_from(&style.words);
        }
        profile.wording.apply_choice(style.choice);
        profile
    }

    /// Measures English texts; texts without words are ignored.
    #[must_use]
    pub fn from_references(references: &[String]) -> Self {
        Self::in_language(references, "")
    }

    /// Measures texts for a style that is written in the language with this tag. The texts may be in English or in that language.
    fn in_language(references: &[String], tag: &str) -> Self {
        let built_in = LanguageWording::built_in(tag);
        let worded = references.iter().filter(|text| word_count(text) > 0);
        let all: Vec<ReadableText<'_>> = worded.map(|text| ReadableText::new(text, None)).collect();
        let texts: Vec<&str> = all.iter().map(ReadableText::english).collect();
        let readings: Vec<TextReading> = texts.iter().map(|text| read_instruction(text, &BTreeSet::new())).collect();
        let mut way = WayWording::from_texts(texts.iter().copied().zip(&readings));
        let language = built_in
            .map(|built_in| learn_wording(built_in, all.iter().zip(&readings).filter(|(text, _)| text.is_glossed())));
        if let Some(language) = built_in.filter(|_| all.iter().any(ReadableText::is_glossed)) {
            language.adapt_plan(&mut way);
        }
        let length = |at: usize| match &language {
            Some(language) if all[at].is_glossed() => language.words_for(all[at].text(), &way),
            _ => word_count(texts[at]),
        };
        let count = texts.len().max(1) as f64;
        let share = |holds: &dyn Fn(usize) -> bool| (0..texts.len()).filter(|at| holds(*at)).count() as f64 / count;
        let events = |is: &dyn Fn(&EventContent) -> bool| {
            readings.iter().flat_map(|reading| &reading.events).filter(|event| is(&event.what)).count() as f64 / count
        };
        let sorted = |measure: &dyn Fn(usize) -> usize| {
            let mut values: Vec<usize> = (0..texts.len()).map(measure).collect();
            values.sort_unstable();
            values
        };
        Self {
            words: sorted(&length),
            sentences: sorted(&|at| readings[at].count_sentences()),
            turns: events(&|what| matches!(what, EventContent::Turn(_))),
            places: events(&|what| matches!(what, EventContent::Place(_))),
            tasks: share(&|at| readings[at].task.is_some()),
            floors: share(&|at| readings[at].events.iter().any(|event| matches!(event.what, EventContent::Floor(_)))),
            full_stops: share(&|at| texts[at].trim_end().ends_with(['.', '!'])),
            way,
            language,
            wording: measure_wording(&readings),
            copies: Arc::new(ReferenceRuns::from_readings(all.iter().zip(&readings))),
        }
    }

    /// Whether the texts describe the way turn by turn: they have at least two turn words in five texts.
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
        let style = InstructionStyle { words: vec![5, 7], ..built_in("r2r").unwrap() };
        assert_eq!(StyleProfile::for_style(&style).words, [5, 7]);
        let style = built_in("r2r").unwrap();
        assert_eq!(StyleProfile::for_style(&style).words, StyleProfile::from_references(&style.references).words);
    }

    #[test]
    fn from_references_separates_the_coarse_and_the_fine_style() {
        let coarse = StyleProfile::from_references(&built_in("reverie").unwrap().references);
        assert!(
            !coarse.tells_turns() && coarse.tasks > 0.8 && coarse.sentences.iter().all(|count| *count == 1),
            "{coarse:?}"
        );
        let fine = StyleProfile::from_references(&built_in("r2r").unwrap().references);
        assert!(fine.tells_turns() && fine.tasks == 0.0 && fine.full_stops == 1.0, "{fine:?}");
    }
}

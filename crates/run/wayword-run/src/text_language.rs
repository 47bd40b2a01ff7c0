//! Finds sets of texts in another language than English, and reports what the program reads of it.

use crate::output::CommandOutput;
use std::collections::BTreeSet;
use wayword_language::{Language, languages::reads_in_part, reading::read_instruction};

/// Number of texts by which the language of a set is judged.
const JUDGED_TEXTS: usize = 20;
/// Most characters of a text that a message shows.
const SHOWN_CHARS: usize = 60;

/// Texts of which most are in another language than English.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ForeignTexts {
    /// The language of the first such text.
    pub language: &'static str,
    /// The beginning of that text.
    pub example: String,
}

impl ForeignTexts {
    /// Looks at the first texts of a set; `None` if most of them are English.
    #[must_use]
    pub fn find<'a>(texts: impl IntoIterator<Item = &'a str>) -> Option<Self> {
        let judged: Vec<&str> = texts.into_iter().take(JUDGED_TEXTS).collect();
        let foreign = judged.iter().filter_map(|text| match read_instruction(text, &BTreeSet::new()).language {
            Language::Other(language) => Some((language, text.chars().take(SHOWN_CHARS).collect())),
            Language::English | Language::Partly(_) => None,
        });
        let foreign: Vec<(&'static str, String)> = foreign.collect();
        let is_most = foreign.len() * 2 > judged.len();
        foreign.into_iter().next().filter(|_| is_most).map(|(language, example)| Self { language, example })
    }
}

/// Tells of texts of which most are in another language, and warns where the program reads that only in part or not at all. `owner` names
/// their set: " of set a".
pub fn warn_of_foreign<'a>(owner: &str, texts: impl IntoIterator<Item = &'a str>, output: &CommandOutput) {
    let Some(ForeignTexts { language, .. }) = ForeignTexts::find(texts) else { return };
    match reads_in_part(language) {
        Some(false) => output.say(format_args!(
            "note: most of the texts{owner} are in {language}, which checks and the agents reader and reader-map read through English words"
        )),
        Some(true) => output.say(format_args!(
            "warning: most of the texts{owner} are in {language}, of which the program reads turns, sides, climbs and numbers alone (experimental)"
        )),
        None => output.say(format_args!(
            "warning: most of the texts{owner} are in {language}; the program does not read it, and understands none of these"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn language(texts: &[&str]) -> Option<&'static str> {
        ForeignTexts::find(texts.iter().copied()).map(|found| found.language)
    }

    #[test]
    fn the_language_of_a_set_is_that_of_most_of_its_texts() {
        let (german, english) = ("Gehe an der Lampe vorbei und warte am Schreibtisch.", "Walk past the lamp and wait.");
        assert_eq!(language(&[german]), Some("German"));
        assert_eq!(language(&[german, english]), None);
        let spanish = ["Gire a la izquierda y espere en la cocina.", "Camine hasta la puerta.", english];
        assert_eq!(language(&spanish), Some("Spanish"));
        assert_eq!(language(&["चलो और दरवाजे पर रुको।"]), Some("Hindi"));
        assert_eq!(language(&["走出卫生间然后左转。"]), Some("Chinese"));
        assert_eq!(language(&[english, "", "..."]), None);
        assert_eq!(language(&[]), None);
        let long = format!("{german} {german}");
        assert_eq!(ForeignTexts::find([long.as_str()]).unwrap().example.chars().count(), SHOWN_CHARS);
    }
}

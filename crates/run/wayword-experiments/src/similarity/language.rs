//! Refuses figures of texts in different languages: their words have nothing in common.

use crate::text_sets::TextSet;
use wayword_run::{error::CommandError, output::CommandOutput, text_language::ForeignTexts};

/// Refuses two sets in different languages, where the figures count `words`; a model may know both languages. Warns
/// where the languages differ all the same. Returns the language of A.
///
/// # Errors
/// When the languages differ, and words are counted.
pub(super) fn refuse_other_languages(
    sides: [(&str, &TextSet); 2],
    words: bool,
    output: &CommandOutput,
) -> Result<&'static str, CommandError> {
    let language = |items: &TextSet| {
        let texts = items.values().flat_map(|item| item.texts.iter().map(String::as_str));
        ForeignTexts::find(texts).map_or("English", |foreign| foreign.language)
    };
    let [(a, a_texts), (b, b_texts)] = sides;
    let (of_a, of_b) = (language(a_texts), language(b_texts));
    if of_a != of_b && words {
        let problem =
            format!("the texts of {a} are in {of_a}, and those of {b} in {of_b}: they have no words in common");
        return Err(CommandError::usage(problem, "compare texts in one language"));
    }
    if of_a != of_b {
        output.say(format_args!(
            "warning: the texts of {a} are in {of_a}, and those of {b} in {of_b}; few sentence encoders know both"
        ));
    }
    Ok(of_a)
}

/// Warns where texts are not in English, and words are split by the rules of English.
pub(super) fn warn_of_english_rules(language: &str, output: &CommandOutput) {
    if language != "English" {
        output.say(format_args!(
            "warning: the texts are in {language}, and are taken apart by the rules of English, so the figures mean little"
        ));
    }
}

//! Styles of instructions: the built-in ones, those in a user's file, and the measured properties of their reference
//! texts.

mod language;
mod measure;
mod names;
mod profile;
mod verbs;
pub mod way;
mod wording;

use sha2::{Digest, Sha256};
use wayword_core::{InstructionStyle, StyleConstraints, WordingPolicy, hex_text};

pub(crate) use language::TextContent;
pub use language::{LanguageWording, count_shapes};
pub use profile::StyleProfile;
use wording::MAX_SHARP_POWER;
pub use wording::{PlaceWording, WordingShares};

/// The built-in styles: name, and text of the TOML file.
const BUILT_IN: [(&str, &str); 2] =
    [("r2r", include_str!("builtin/r2r.toml")), ("reverie", include_str!("builtin/reverie.toml"))];

/// The built-in wording of places: constructions with their shares.
const PLACE_WORDING_TOML: &str = include_str!("builtin/place.toml");

/// Most reference texts of a style; a style with more is an error.
const MAX_REFERENCES: usize = 100_000;
/// Most bytes of each reference text; a style with a longer one is an error.
const MAX_REFERENCE_BYTES: usize = 4000;

/// Why a style cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StyleError {
    /// A name that is not built in.
    #[error("there is no style {0:?}: name r2r, reverie, or a file that ends in .toml")]
    Unknown(String),
    /// A file that is no valid style.
    #[error("style {name}: {reason}")]
    Unreadable {
        /// The file or name that it came from.
        name: String,
        /// The fault, with line and field.
        reason: String,
    },
    /// The style has no name.
    #[error("a style has no name: give it one")]
    Unnamed,
    /// Its `language` is none that the program writes.
    #[error("style {name}: `language` is {found:?}: write {}", written_languages())]
    UnknownLanguage {
        /// The style.
        name: String,
        /// What it tells.
        found: String,
    },
    /// The style has no reference texts.
    #[error("style {0} has no reference texts: give at least one in `references`")]
    NoReferences(String),
    /// The style has too many or too long reference texts.
    #[error(
        "style {0} has more than {MAX_REFERENCES} reference texts, or one of more than {MAX_REFERENCE_BYTES} bytes: give fewer or shorter ones"
    )]
    TooLarge(String),
    /// A number of its table `choice` is outside its range.
    #[error("style {name}: `choice.{field}` is {found}: write a number from 0 to {most}")]
    ChoiceOutOfRange {
        /// The style.
        name: String,
        /// The field of `choice`.
        field: &'static str,
        /// What it tells.
        found: String,
        /// The greatest number that it takes.
        most: f64,
    },
    /// No text can keep its rules.
    #[error("style {name}: no text can keep its rules: {reason}")]
    Contradictory {
        /// The style, or its file with the line of the field.
        name: String,
        /// The field to change.
        field: &'static str,
        /// The rules, and what to do.
        reason: String,
    },
}

/// The tags of the languages that texts are written in, for a message.
fn written_languages() -> String {
    std::iter::once("en").chain(LanguageWording::written_tags()).collect::<Vec<_>>().join(" or ")
}

/// The names of the built-in styles.
#[must_use]
pub fn built_in_names() -> Vec<&'static str> {
    BUILT_IN.iter().map(|(name, _)| *name).collect()
}

/// A built-in style.
///
/// # Errors
/// When there is none of that name.
pub fn built_in(name: &str) -> Result<InstructionStyle, StyleError> {
    let (name, text) =
        BUILT_IN.iter().find(|(built_in, _)| *built_in == name).ok_or_else(|| StyleError::Unknown(name.to_owned()))?;
    parse_style(name, text)
}

/// The tables of the built-in wording. The file is compiled in, and a test parses it.
fn parse_wording() -> std::collections::BTreeMap<String, WordingShares> {
    toml::from_str(PLACE_WORDING_TOML).unwrap_or_default()
}

/// A style from the text of a TOML file; errors show `name`.
///
/// # Errors
/// When it is no style, or has no or too many references.
pub fn parse_style(name: &str, text: &str) -> Result<InstructionStyle, StyleError> {
    parse_style_with(name, text, Vec::new())
}

/// Like [`parse_style`], with the references in `more` after those of the file.
///
/// # Errors
/// When it is no style, or there are no or too many references.
pub fn parse_style_with(name: &str, text: &str, more: Vec<String>) -> Result<InstructionStyle, StyleError> {
    let unreadable = |reason: String| StyleError::Unreadable { name: name.to_owned(), reason };
    let mut style: InstructionStyle =
        toml::from_str(text).map_err(|error| unreadable(error.to_string().trim().to_owned()))?;
    style.references.extend(more);
    validate_style(style).map_err(|error| match error {
        StyleError::Unnamed => unreadable("its `name` is empty: give it one".into()),
        StyleError::NoReferences(_) => StyleError::NoReferences(name.to_owned()),
        StyleError::TooLarge(_) => StyleError::TooLarge(name.to_owned()),
        StyleError::UnknownLanguage { found, .. } => StyleError::UnknownLanguage { name: name.to_owned(), found },
        StyleError::ChoiceOutOfRange { field, found, most, .. } => {
            StyleError::ChoiceOutOfRange { name: name.to_owned(), field, found, most }
        }
        StyleError::Contradictory { field, reason, .. } => {
            let sets = |line: &str| {
                line.trim_start().strip_prefix(field).is_some_and(|rest| rest.trim_start().starts_with('='))
            };
            let line = text.lines().position(sets).map_or_else(String::new, |at| format!(", line {}", at + 1));
            StyleError::Contradictory { name: format!("{name}{line}"), field, reason }
        }
        other => other,
    })
}

/// Checks that a style can be used: it has a name and references, is not too large, and its numbers are in their ranges.
///
/// # Errors
/// When it has no name, no or too many references, or a choice outside its range, or no text can keep its rules.
pub fn validate_style(style: InstructionStyle) -> Result<InstructionStyle, StyleError> {
    if style.name.trim().is_empty() {
        return Err(StyleError::Unnamed);
    }
    if !matches!(style.language.as_str(), "" | "en") && LanguageWording::built_in(&style.language).is_none() {
        return Err(StyleError::UnknownLanguage { name: style.name, found: style.language });
    }
    if style.references.iter().all(|text| text.trim().is_empty()) {
        return Err(StyleError::NoReferences(style.name));
    }
    if style.references.len() > MAX_REFERENCES || style.references.iter().any(|text| text.len() > MAX_REFERENCE_BYTES) {
        return Err(StyleError::TooLarge(style.name));
    }
    let WordingPolicy { sure, sharp } = style.choice;
    for (field, chosen, most) in [("sure", sure, 1.0), ("sharp", sharp, MAX_SHARP_POWER)] {
        // NaN is in no range.
        if let Some(found) = chosen.filter(|chosen| !(0.0..=most).contains(chosen)) {
            return Err(StyleError::ChoiceOutOfRange { name: style.name, field, found: format!("{found:?}"), most });
        }
    }
    match contradiction_in(&style) {
        Some((field, reason)) => Err(StyleError::Contradictory { name: style.name, field, reason }),
        None => Ok(style),
    }
}

/// Rules of a style that no text can keep together: the field to change, and what to do. A sentence has at least one word.
fn contradiction_in(style: &InstructionStyle) -> Option<(&'static str, String)> {
    let StyleConstraints { min_sentences, max_sentences, fewer_words_than, .. } = style.constraints;
    let least = min_sentences.unwrap_or(1).max(1);
    if let Some(most) = max_sentences.filter(|most| *most < least) {
        let reason = format!("min_sentences is {least}, and max_sentences {most}; change one of them");
        return Some(("max_sentences", reason));
    }
    if !style.words.is_empty() && style.words.iter().all(|words| *words < least) {
        let reason = format!(
            "every number in `words` is below {least}, and each sentence has at least one word; change it or min_sentences"
        );
        return Some(("words", reason));
    }
    let limit = fewer_words_than?;
    if limit <= least {
        let reason = format!("min_sentences is {least}, and fewer_words_than {limit}; change one of them");
        return Some(("fewer_words_than", reason));
    }
    let are_too_long = !style.words.is_empty() && style.words.iter().all(|words| *words >= limit);
    are_too_long
        .then(|| ("words", format!("every number in `words` is {limit} or more; change it or fewer_words_than")))
}

/// A short hash of a style's content, for provenance.
#[must_use]
pub fn hash_style(style: &InstructionStyle) -> String {
    let json = serde_json::to_vec(style).unwrap_or_default();
    hex_text(&Sha256::digest(json)[..8])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use wayword_checks::{ReferenceRuns, TextTopic};
    use wayword_language::{
        reading::read_instruction,
        text::{sentence_count, split_tokens, word_count},
    };

    #[test]
    fn the_built_in_references_keep_their_own_constraints() {
        for name in built_in_names() {
            let style = built_in(name).unwrap();
            for text in &style.references {
                assert!(style.constraints.fewer_words_than.is_none_or(|limit| word_count(text) < limit), "{text}");
                assert!(style.constraints.min_sentences.is_none_or(|least| sentence_count(text) >= least), "{text}");
            }
        }
    }

    #[test]
    fn no_reference_repeats_another() {
        for name in built_in_names() {
            let style = built_in(name).unwrap();
            for (at, text) in style.references.iter().enumerate() {
                let others = ReferenceRuns::from_references(&style.references[at + 1..]);
                assert_eq!(others.find_copy(&split_tokens(text), TextTopic::default()), None, "{text}");
            }
        }
    }

    #[test]
    fn no_reference_without_a_task_is_read_as_one() {
        for text in built_in("r2r").unwrap().references {
            assert_eq!(read_instruction(&text, &BTreeSet::new()).task, None, "{text}");
        }
    }

    #[test]
    fn invalid_styles_are_refused_with_a_reason() {
        assert!(matches!(built_in("poem"), Err(StyleError::Unknown(_))));
        assert!(parse_style("x", "name = 3").unwrap_err().to_string().contains("style x"));
        let unnamed = parse_style("x.toml", "name = \" \"\nreferences = [\"Stop.\"]").unwrap_err().to_string();
        assert!(unnamed.contains("x.toml") && unnamed.contains("`name` is empty"), "{unnamed}");
        let unnamed = InstructionStyle { name: String::new(), ..built_in("r2r").unwrap() };
        assert_eq!(validate_style(unnamed), Err(StyleError::Unnamed));
        let empty = parse_style("x.toml", "name = \"x\"\nreferences = [\" \"]");
        assert_eq!(empty, Err(StyleError::NoReferences("x.toml".into())));
        for (rules, told) in [
            ("min_sentences = 5\nmax_sentences = 2", "min_sentences is 5, and max_sentences 2"),
            ("max_sentences = 0", "max_sentences 0"),
            ("fewer_words_than = 1", "fewer_words_than 1"),
            ("min_sentences = 9\nfewer_words_than = 9", "min_sentences is 9, and fewer_words_than 9"),
        ] {
            let text = format!("name = \"x\"\nreferences = [\"Stop.\"]\n[constraints]\n{rules}");
            let error = parse_style("x.toml", &text).unwrap_err().to_string();
            assert!(error.contains(told) && error.contains("; change "), "{error}");
            assert!(error.starts_with("style x.toml, line "), "{error}");
        }
        let text = "name = \"x\"\nreferences = [\"Stop.\"]\nwords = [0, 2]\n[constraints]\nmin_sentences = 3";
        let told = parse_style("x.toml", text).unwrap_err().to_string();
        assert!(told.starts_with("style x.toml, line 3: ") && told.contains("`words` is below 3"), "{told}");
        let text = "name = \"x\"\nreferences = [\"Stop.\"]\nwords = [8, 12]\n[constraints]\nfewer_words_than = 8";
        assert!(parse_style("x.toml", text).unwrap_err().to_string().contains("every number in `words` is 8 or more"));
        assert!(parse_style("x.toml", &text.replace("= 8", "= 9")).is_ok());
        for (rules, told) in [
            ("sure = nan", "`choice.sure` is NaN: write a number from 0 to 1"),
            ("sure = inf", "`choice.sure` is inf"),
            ("sure = 7", "`choice.sure` is 7.0"),
            ("sure = -0.1", "`choice.sure` is -0.1"),
            ("sharp = 1e308", "`choice.sharp` is 1e308: write a number from 0 to 10"),
            ("sure = 1\nsharp = -inf", "`choice.sharp` is -inf"),
        ] {
            let text = format!("name = \"x\"\nreferences = [\"Stop.\"]\n[choice]\n{rules}");
            let error = parse_style("mine.toml", &text).unwrap_err().to_string();
            assert!(error.starts_with("style mine.toml: ") && error.contains(told), "{error}");
        }
        let ends = "name = \"x\"\nreferences = [\"Stop.\"]\n[choice]\nsure = 0\nsharp = 10";
        assert!(parse_style("x.toml", ends).is_ok());
        let long = format!("name = \"x\"\nreferences = [\"{}\"]", "a".repeat(4001));
        let long = parse_style("x.toml", &long).unwrap_err().to_string();
        assert!(
            long.starts_with("style x.toml has more than 100000 reference texts, or one of more than 4000 bytes: ")
        );
    }
}

//! Languages beside English. What reads English reads them too, through a gloss.
//!
//! A pack is a folder with two files. `words.txt` has the words of the language with their classes and the English words that mean the
//! same there, so that "沙发" and "sofa" are one name to whatever reads. `rules.txt` gives the English of phrases of these classes.
//! A pack is data alone: a language is added by a folder and a row in `PACKS`.
//!
//! [`ReadableText`] is a text with its gloss. Byte ranges of the gloss are turned back into those of the text where people see them.

mod chunks;
mod gloss;
mod naming;
mod pack_words;
mod rules;

pub use gloss::ReadableText;
pub use naming::{NameSense, names_within, word_for_look, word_for_name};

use crate::Language;
use crate::language::script_language;
use gloss::{GlossedText, LanguagePack};
use std::sync::LazyLock;

/// The files of a pack.
struct PackFiles {
    /// The name of the language, as [`Language`] has it.
    language: &'static str,
    words: &'static str,
    rules: &'static str,
    /// Whether blanks part its words.
    is_spaced: bool,
    /// Whether only some constructions are read.
    is_experimental: bool,
}

const PACKS: [PackFiles; 2] = [
    PackFiles {
        language: "Chinese",
        words: include_str!("zh/words.txt"),
        rules: include_str!("zh/rules.txt"),
        is_spaced: false,
        is_experimental: false,
    },
    PackFiles {
        language: "Hindi",
        words: include_str!("hi/words.txt"),
        rules: include_str!("hi/rules.txt"),
        is_spaced: true,
        is_experimental: true,
    },
];

static READ_PACKS: LazyLock<Vec<LanguagePack>> = LazyLock::new(|| PACKS.iter().map(LanguagePack::parse).collect());

/// A text in English words, where most of it is in the script of a language that has a pack; `None` for
/// English, and for what is not read.
fn gloss_text(text: &str) -> Option<GlossedText> {
    let Language::Other(language) = script_language(text) else { return None };
    let pack = READ_PACKS.iter().find(|pack| pack.language == language)?;
    Some(pack.gloss(text))
}

/// Whether the program reads a language: `Some(true)` only in part, as an experiment; `None` where it does not.
#[must_use]
pub fn reads_in_part(language: &str) -> Option<bool> {
    PACKS.iter().find(|files| files.language == language).map(|files| files.is_experimental)
}

#[cfg(test)]
mod tests;

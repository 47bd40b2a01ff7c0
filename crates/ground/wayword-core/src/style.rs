//! Styles: kinds of instruction, described by reference texts and by rules. They are data, which users can add to.

use serde::{Deserialize, Serialize};

/// A kind of instruction: reference texts that show it, and the rules for every text of this kind.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InstructionStyle {
    /// Its name, as `--style` takes it.
    pub name: String,
    /// Texts in this style. The writer imitates their shape and may not copy them.
    #[serde(default)]
    pub references: Vec<String>,
    /// How many words its texts have: a writer draws from these. Where there are none, the lengths of the references count.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub words: Vec<usize>,
    /// How a writer by rules chooses among wordings, apart from how often people of the style use them.
    #[serde(default, skip_serializing_if = "WordingPolicy::is_open")]
    pub choice: WordingPolicy,
    /// The rules for a text of this style.
    #[serde(default)]
    pub constraints: StyleConstraints,
}

/// Choices that references cannot show. A field that is `None` is left to the program.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WordingPolicy {
    /// In which share of texts the target is described until no other object fits, 0 to 1. The others have as many
    /// details as people give.
    pub sure: Option<f64>,
    /// By which power of their share wordings are drawn, 0 to 10. At 1 as people do; above it, the commonest oftener.
    pub sharp: Option<f64>,
}

impl WordingPolicy {
    /// Whether it leaves every choice to the program.
    fn is_open(&self) -> bool {
        *self == Self::default()
    }
}

/// Rules that a text of a style is checked against. A field that is `None` or false sets no rule.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StyleConstraints {
    /// Least number of sentences.
    pub min_sentences: Option<usize>,
    /// Greatest number of sentences.
    pub max_sentences: Option<usize>,
    /// A bound on the number of words: the text has fewer.
    pub fewer_words_than: Option<usize>,
    /// The text ends in a task on an object of the final viewpoint.
    pub ends_in_task: bool,
}

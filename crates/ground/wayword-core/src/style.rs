//! Styles as data: what instructions of a kind look like.

use serde::{Deserialize, Serialize};

/// A kind of instruction: reference texts that show it, and what every such text must keep to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Style {
    /// Its name, as `--style` takes it.
    pub name: String,
    /// Texts in this style; the writer imitates their shape and may not copy them.
    pub references: Vec<String>,
    /// What a text of this style must keep to.
    #[serde(default)]
    pub constraints: Constraints,
}

/// Rules that a text can be checked against. What is `None` or false is not asked for.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Constraints {
    /// At least so many sentences.
    pub min_sentences: Option<usize>,
    /// At most so many sentences.
    pub max_sentences: Option<usize>,
    /// Fewer words than this.
    pub fewer_words_than: Option<usize>,
    /// The text ends in a task on an object of the final viewpoint.
    pub ends_in_task: bool,
}

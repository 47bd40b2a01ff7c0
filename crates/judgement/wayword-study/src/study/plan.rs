//! What is fixed when a study is made.

use serde::{Deserialize, Serialize};

/// What people do with an item.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// They walk the viewpoint graph by the text alone.
    Follow,
    /// They watch a film of the path and answer four questions about the text.
    Rate,
    /// They watch the film and choose between two texts.
    Pair,
}

impl Mode {
    /// Its name, as `--mode` takes it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Follow => "follow",
            Self::Rate => "rate",
            Self::Pair => "pair",
        }
    }
}

/// Where the texts of a condition come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// A run, or a file of texts.
    Run,
    /// The people who wrote the dataset.
    People,
    /// A text of another path in the same scene: what a wrong text reaches.
    OtherPath,
}

/// One of the sets of texts that the study compares.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    /// Its name in the results.
    pub name: String,
    /// What it is.
    pub kind: Kind,
    /// Where the texts come from, as the user gave it.
    pub source: String,
    /// Whether people see which words to doubt.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub shows_doubts: bool,
}

/// What is fixed when a study is made, because answers under different plans cannot be put together.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// What people do.
    pub mode: Mode,
    /// Seed of everything random but tokens.
    pub seed: u64,
    /// How many answers each item shall have.
    pub per_item: u32,
    /// How many items a person gets, at most.
    pub per_participant: u32,
    /// The conditions, in the order of the tables.
    pub conditions: Vec<Condition>,
    /// The style of the texts, whose examples the people see; empty where it is not known.
    pub style: String,
}

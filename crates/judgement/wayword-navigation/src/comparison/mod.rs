//! Compares sets of instructions by how well agents walk by them: the paper's table, with intervals, bounds and swap
//! tests.

mod efforts;
mod results;
mod table;

pub use efforts::Efforts;
pub use results::Results;
pub use table::{EMPTY, UNREAD, Walker, compare, empty_set, swapped_set};

use crate::swap::Swap;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use wayword_metrics::{Estimate, McNemar, Metric, Rule};

/// Everything that a comparison found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// What it is about and how it was made.
    pub about: About,
    /// The sets, in the order in which they were asked for.
    pub sets: Vec<Set>,
    /// One per agent and set, agents in their order; an agent that does not read has one row, whose set is `None`. One that
    /// reads and knows the map has two more: by an empty text ([`empty_set`]) and by another path's ([`swapped_set`]).
    pub rows: Vec<Row>,
    /// One per agent that reads all of its text, and swap of the first set.
    pub swaps: Vec<Swapped>,
}

/// What a comparison is about.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// The platform.
    pub platform: String,
    /// Name of the episodes' file.
    pub episodes: String,
    /// The grounder, which scores how well phrases fit views; `labels` is ground truth, not perception.
    pub grounder: String,
    /// The same for agents that walk by a detector.
    pub detector: String,
    /// What a score of that detector is, where it is a network.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detector_score: Option<String>,
    /// The sentence encoder behind `labels`, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub encoder: Option<String>,
    /// What splits instructions.
    pub splitter: String,
    /// The language model of the agent that walks by tools, and how it sees: `labels`, `pictures`, or the model that
    /// describes pictures. `None` without that agent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tools: Option<(String, String)>,
    /// The rule of success in the table.
    pub rule: Rule,
    /// What intervals cover, as 0.95.
    pub level: f64,
    /// Resamples of the intervals.
    pub resamples: usize,
    /// Seed of everything random.
    pub seed: u64,
    /// Items that every set has and that could be walked, which all rows are about.
    pub items: usize,
    /// Paths on which those items lie: items on one path are not independent.
    pub paths: usize,
    /// Items that every set has and that no agent walked, because a model failed on one of their texts.
    pub failed: usize,
    /// Whether the parameters are the defaults and were swept for this grounder.
    pub swept: bool,
    /// Which walks an agent that reads and knows the map thinks of; `None` without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prior: Option<String>,
    /// The agents' parameters, by agent and name.
    pub parameters: BTreeMap<String, BTreeMap<String, String>>,
    /// Version of Wayword.
    pub wayword: String,
}

/// A set of instructions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Set {
    /// Its name.
    pub name: String,
    /// Where it is from, without folders.
    pub source: String,
    /// Its texts on the common items.
    pub texts: usize,
    /// Its items that another set lacks, and that are left out.
    pub left_out: usize,
    /// Its mean length, words.
    pub words: f64,
}

/// What kind of agent a row is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AgentKind {
    /// It knows nothing and reads nothing.
    #[serde(alias = "floor")] // The name in comparisons that were made before.
    LowerBound,
    /// It reads.
    Agent,
    /// It knows what no agent gets: the map, the labels of rooms, for some those of objects.
    Informed,
    /// It knows the goal.
    #[serde(alias = "ceiling")]
    UpperBound,
}

/// An agent's figures on one set. A text's figure is its walk's, an item's the mean over its texts, the row's the mean over
/// items.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The agent.
    pub agent: String,
    /// What kind it is.
    pub kind: AgentKind,
    /// The set that it walked by; `None` where it does not read.
    pub set: Option<String>,
    /// Each figure with its interval, clustered by path.
    pub figures: BTreeMap<Metric, Estimate>,
    /// This row less the first set's of the same agent; `None` for the first set and for those that do not read.
    pub against_first: Option<Difference>,
    /// What its walks took, where a language model decided.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effort: Option<Efforts>,
}

/// One row less another of the same agent, item by item.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// Each figure's difference with its interval, clustered by path.
    pub figures: BTreeMap<Metric, Estimate>,
    /// On the success of each item's first text. It treats items as independent, which they are not, so it only
    /// describes.
    pub mcnemar: McNemar,
}

/// What a swap of the first set does to an agent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Swapped {
    /// The agent.
    pub agent: String,
    /// The swap.
    pub swap: Swap,
    /// Texts that the swap changed; where it changes nothing a text is left out, on both sides.
    pub changed: usize,
    /// Texts of the first set on the common items.
    pub texts: usize,
    /// The agent's figures by the swapped texts.
    pub figures: BTreeMap<Metric, Estimate>,
    /// The figures by the original texts less those by the swapped ones, on the same items and texts: positive where
    /// the agent listens to what was swapped.
    pub lost: Difference,
    /// What that shows.
    pub listening: Listening,
}

/// Whether an agent listens to what was swapped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Listening {
    /// The whole interval of the lost success rate is above 0.
    Shown,
    /// It is not. That does not show that the agent does not listen.
    NotShown,
    /// The swap changed texts on fewer than [`FEWEST_PATHS`] paths, too few for an interval that means anything.
    TooFew,
}

/// The fewest paths on which an interval that draws paths means anything.
pub const FEWEST_PATHS: usize = 20;

#[cfg(test)]
mod tests;

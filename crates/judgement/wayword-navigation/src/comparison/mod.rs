//! Compares sets of instructions by how well agents walk by them: the table of the paper (arXiv 2403.11487), with intervals, lower
//! and upper bounds, and swap tests that show whether an agent uses the text at all.

mod effort_summary;
mod results;
mod table;

pub use effort_summary::EffortSummary;
pub use results::WalkScores;
pub use table::{ComparedAgent, EMPTY_SET_SUFFIX, UNREAD_SET_NAME, compare_agents, empty_set, swapped_set};

use crate::swap::InstructionSwap;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use wayword_metrics::{McNemar, MeanEstimate, TrajectoryMetric, TrajectorySuccessRule};

/// The result of a comparison: its settings, the table, and the swap tests.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AgentComparison {
    /// Its subject and its settings.
    pub about: ComparisonInfo,
    /// The sets, in the order in which they were asked for.
    pub sets: Vec<InstructionSet>,
    /// One row per agent and set, agents in their order. An agent that does not read has one row, with `None` as its set. An agent
    /// that reads and knows the map has two more: by an empty text ([`empty_set`]) and by the text of another path
    /// ([`swapped_set`]).
    pub rows: Vec<ComparisonRow>,
    /// The swap tests of the first set: one per swap and agent that is tested.
    pub swaps: Vec<SwapEffect>,
}

/// The subject and the settings of a comparison.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ComparisonInfo {
    /// The platform.
    pub platform: String,
    /// Name of the episodes' file.
    pub episodes: String,
    /// The grounder, which scores how well phrases fit views; `labels` is ground truth, not perception.
    pub grounder: String,
    /// The detector, which scores phrases for agents that walk by one.
    pub detector: String,
    /// The meaning of that detector's scores, if it is a network.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detector_score: Option<String>,
    /// The sentence encoder behind `labels`, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub encoder: Option<String>,
    /// The splitter of instructions: `rules` or a model.
    pub splitter: String,
    /// The language model of the agent that walks by tools, and how it sees: `labels`, `pictures`, or the model that
    /// describes pictures. `None` without that agent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tools: Option<(String, String)>,
    /// The rule of success in the table.
    pub rule: TrajectorySuccessRule,
    /// The share that intervals cover, as 0.95.
    pub level: f64,
    /// Resamples of the intervals.
    pub resamples: usize,
    /// Seed of everything random.
    pub seed: u64,
    /// Items that every set has and that could be walked. All rows are about these.
    pub items: usize,
    /// Paths on which those items lie: items on one path are not independent.
    pub paths: usize,
    /// Items that every set has and that no agent walked, because a model failed on one of their texts.
    pub failed: usize,
    /// Whether the parameters are the defaults and were swept for this grounder.
    pub swept: bool,
    /// Which walks an agent that reads and knows the map considers; `None` without such an agent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prior: Option<String>,
    /// The agents' parameters, by agent and name.
    pub parameters: BTreeMap<String, BTreeMap<String, String>>,
    /// Version of Wayword.
    pub wayword: String,
}

/// A set of instructions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InstructionSet {
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

/// How much an agent knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AgentKind {
    /// It neither reads nor knows the scene.
    #[serde(alias = "floor")] // The name in files of earlier versions, as "ceiling" below.
    LowerBound,
    /// It reads.
    Agent,
    /// It knows more than an agent may: the map, the labels of rooms, and in some cases those of objects.
    Informed,
    /// It knows the goal.
    #[serde(alias = "ceiling")]
    UpperBound,
}

/// An agent's figures on one set. The figure of an item is the mean over the walks by its texts, and the figure of the row is the
/// mean over items.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ComparisonRow {
    /// The agent.
    pub agent: String,
    /// What kind it is.
    pub kind: AgentKind,
    /// The set that it walked by; `None` where it does not read.
    pub set: Option<String>,
    /// Each figure with its interval, clustered by path.
    pub figures: BTreeMap<TrajectoryMetric, MeanEstimate>,
    /// This row minus the row of the first set for the same agent; `None` for the first set and for agents that do not read.
    pub against_first: Option<RowDifference>,
    /// Calls, tokens and cost of its walks, if a language model decided.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effort: Option<EffortSummary>,
}

/// One row minus another of the same agent, item by item.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RowDifference {
    /// Each figure's difference with its interval, clustered by path.
    pub figures: BTreeMap<TrajectoryMetric, MeanEstimate>,
    /// On the success of each item's first text. It treats items as independent, which they are not, so it only
    /// describes.
    pub mcnemar: McNemar,
}

/// The effect of a swap of the first set on an agent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SwapEffect {
    /// The agent.
    pub agent: String,
    /// The swap.
    pub swap: InstructionSwap,
    /// Texts that the swap changed. Texts that it leaves as they are do not count on either side.
    pub changed: usize,
    /// Texts of the first set on the common items.
    pub texts: usize,
    /// The agent's figures by the swapped texts.
    pub figures: BTreeMap<TrajectoryMetric, MeanEstimate>,
    /// The figures by the original texts minus those by the swapped ones, on the same items and texts: positive if the agent uses
    /// the swapped information.
    pub lost: RowDifference,
    /// The conclusion from `lost`.
    pub listening: ListeningVerdict,
}

/// Whether a swap test shows that an agent uses the swapped information.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ListeningVerdict {
    /// The whole interval of the lost success rate is above 0.
    Shown,
    /// The interval includes 0 or less. This does not prove that the agent ignores the swapped information.
    NotShown,
    /// The swap changed texts on fewer than [`MIN_PATHS`] paths, too few for a reliable interval.
    TooFew,
}

/// The fewest paths for which a bootstrap interval over paths is reliable. With fewer, a swap test gives [`ListeningVerdict::TooFew`].
pub const MIN_PATHS: usize = 20;

#[cfg(test)]
mod tests;

//! The record of one walk: every step of an agent, why the walk ended, and what it cost. It is a line of the file of walks, so the
//! field names are part of a file format.

use crate::directions::SplitInstruction;
use serde::{Deserialize, Serialize};
use wayword_core::{Heading, ObjectId, SceneId, ViewpointId};

/// One agent's walk by one instruction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AgentWalkRecord {
    /// The agent (`clip-nav`, `random/5`).
    pub agent: String,
    /// Which set the instruction is from (`original`, `central`), or how an original was swapped (`original~other-path`).
    pub set: String,
    /// The item: its id in the episodes.
    pub item: String,
    /// Which of the item's instructions in that set, from 0.
    pub text_index: usize,
    /// The instruction.
    pub text: String,
    /// The scene.
    pub scene: SceneId,
    /// The instruction as it was split for the agent; `None` for an agent that does not read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub directions: Option<SplitInstruction>,
    /// Every node where the agent was, in order; at least the start.
    pub steps: Vec<AgentStep>,
    /// Why the walk ended.
    pub end: WalkEnd,
    /// The object that it takes for the target, where its grounder can name one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<ObjectId>,
    /// Calls, tokens and cost, for an agent with a language model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effort: Option<WalkEffort>,
}

/// A stop at a node, and the agent's decision there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AgentStep {
    /// The node.
    pub viewpoint: ViewpointId,
    /// The direction of the hop that led here; at the start the episode's.
    pub heading_rad: Heading,
    /// The scores of the four views. Empty on the way back over nodes, and for agents that do not look.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub views: Vec<StepViewScores>,
    /// The current key phrase when it looked, from 0; beyond the last where only the activity is left.
    #[serde(default)]
    pub phrase: usize,
    /// A summary of the surroundings, for an agent that reads; `None` for the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub told: Option<SurroundingsSummary>,
    /// Its decision.
    pub choice: StepChoice,
    /// The reason, in the words of the model that decided; `None` if no model decided, or it gave no reason.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

impl AgentStep {
    /// A stop without views, surroundings or a reason.
    pub(crate) fn new(viewpoint: ViewpointId, heading_rad: Heading, choice: StepChoice) -> Self {
        Self { viewpoint, heading_rad, views: Vec::new(), phrase: 0, told: None, choice, reason: None }
    }
}

/// Calls, tokens and cost of one walk of an agent with a language model. Calls of a model that only describes pictures are not
/// counted.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct WalkEffort {
    /// Calls of the model.
    pub calls: usize,
    /// How often it looked around.
    pub looks: usize,
    /// Tokens of all prompts.
    pub tokens_in: u64,
    /// Tokens of the largest prompt.
    pub most_tokens_in: u64,
    /// Tokens of all replies.
    pub tokens_out: u64,
    /// US dollars of the replies; `None` where a price is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub usd: Option<f64>,
    /// Seconds that the model took, as measured when the calls were made. Replies from the ledger keep their first time.
    pub seconds: f64,
    /// Counts of useless replies.
    #[serde(default)]
    pub useless: UselessReplies,
    /// The problem of the last useless reply, and how that reply began.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last_useless: Option<String>,
    /// Views that could not be described.
    #[serde(default)]
    pub undescribed: usize,
}

/// Counts of useless replies, by problem.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct UselessReplies {
    /// The reply calls no tool.
    pub no_call: usize,
    /// The reply names a way that does not exist.
    pub no_way: usize,
    /// The reply only looks around again, at a place where the agent has already looked around.
    pub idle: usize,
    /// The service gave no reply: it refused, filtered or failed.
    pub failed: usize,
}

impl UselessReplies {
    /// The number of all useless replies.
    #[must_use]
    pub fn sum(&self) -> usize {
        self.no_call + self.no_way + self.idle + self.failed
    }
}

/// The scores of one of the four views of a step (north, east, south, west). In files it is written as a list of its three
/// values, because files contain many of them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(from = "(f32, f32, usize)", into = "(f32, f32, usize)")]
pub struct StepViewScores {
    /// How well the current key phrase fits it.
    pub phrase: f32,
    /// How well the activity fits it.
    pub activity: f32,
    /// How many neighbours lie in it.
    pub ways: usize,
}

/// A summary of what an agent that reads learned at a step.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SurroundingsSummary {
    /// The room, if it was given to the agent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub room: Option<String>,
    /// Number of ways out.
    pub ways: usize,
    /// Number of things.
    pub things: usize,
}

/// The agent's decision at a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StepChoice {
    /// Went on through one of the four views, from 0.
    Onward(usize),
    /// Went on without looking (baselines, upper bounds, and agents that know the map).
    Unseeing,
    /// Went back to a node where it had been: the sequence of scores was too low, or the text fits another way better.
    Back,
    /// Ended the walk here.
    Stop,
}

/// Why a walk ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WalkEnd {
    /// The agent took the place for the goal.
    Stopped,
    /// The agent had made as many steps as its limit allows.
    Cap,
    /// There was nowhere to go.
    DeadEnd,
    /// The agent had made as many calls of its model as its limit allows.
    Calls,
    /// The cost of its model had reached the limit of a walk.
    Money,
    /// The agent repeated one hop too often.
    Circles,
    /// Several replies of its model in a row were useless.
    NoUse,
}

impl From<(f32, f32, usize)> for StepViewScores {
    fn from((phrase, activity, ways): (f32, f32, usize)) -> Self {
        Self { phrase, activity, ways }
    }
}

impl From<StepViewScores> for (f32, f32, usize) {
    fn from(scored: StepViewScores) -> Self {
        (scored.phrase, scored.activity, scored.ways)
    }
}

//! What an agent did, step by step.

use crate::directions::Directions;
use serde::{Deserialize, Serialize};
use wayword_core::{Heading, ObjectId, SceneId, ViewpointId};

/// One agent's walk by one instruction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Walk {
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
    /// The instruction as it was split for the agent; `None` for one that does not read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub directions: Option<Directions>,
    /// Every node at which it stood, in order; at least the start.
    pub steps: Vec<Step>,
    /// Why it ended.
    pub end: End,
    /// The object that it takes for the target, where its grounder can name one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<ObjectId>,
    /// What it took, for an agent by a language model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effort: Option<Effort>,
}

/// A stop at a node, and what was decided there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// The node.
    pub viewpoint: ViewpointId,
    /// The direction of the hop that led here; at the start the episode's.
    pub heading_rad: Heading,
    /// What was seen and scored. Empty on the way back over nodes, and for agents that look at nothing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub views: Vec<Scored>,
    /// The current key phrase when it looked, from 0; beyond the last where only the activity is left.
    #[serde(default)]
    pub phrase: usize,
    /// What an agent that reads was told there; `None` for the others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub told: Option<Told>,
    /// What it did then.
    pub choice: Choice,
    /// Why, in the words of the model that decided; `None` where no model did, or it gave no reason.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

impl Step {
    /// A stop at a node of an agent that neither looked nor was told anything, and gave no reason.
    pub(crate) fn new(viewpoint: ViewpointId, heading_rad: Heading, choice: Choice) -> Self {
        Self { viewpoint, heading_rad, views: Vec::new(), phrase: 0, told: None, choice, reason: None }
    }
}

/// What a walk of an agent by a language model took. Calls of a model that only describes pictures are not counted.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Effort {
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
    /// Seconds that the model took, when the calls were made.
    pub seconds: f64,
    /// Replies of no use.
    #[serde(default)]
    pub useless: Useless,
    /// What was wrong with the last of them, and how it began.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last_useless: Option<String>,
    /// Views that could not be described.
    #[serde(default)]
    pub undescribed: usize,
}

/// Replies of no use, by what was wrong with them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Useless {
    /// They call no tool.
    pub no_call: usize,
    /// They name a way that there is not.
    pub no_way: usize,
    /// They only look around once more, where the agent stands and has looked around.
    pub idle: usize,
    /// The service gave none: it refused, filtered or failed.
    pub failed: usize,
}

impl Useless {
    /// All of them.
    #[must_use]
    pub fn sum(&self) -> usize {
        self.no_call + self.no_way + self.idle + self.failed
    }
}

/// One of the four views of a step: north, east, south, west. In files it is a list of its three values, because there
/// are many of them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(from = "(f32, f32, usize)", into = "(f32, f32, usize)")]
pub struct Scored {
    /// How well the current key phrase fits it.
    pub phrase: f32,
    /// How well the activity fits it.
    pub activity: f32,
    /// How many neighbours lie in it.
    pub ways: usize,
}

/// What an agent that reads was told at a step, in short.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Told {
    /// The room, where it was told one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub room: Option<String>,
    /// Number of ways out.
    pub ways: usize,
    /// Number of things.
    pub things: usize,
}

/// What an agent did at a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Choice {
    /// Went on through one of the four views, from 0.
    Onward(usize),
    /// Went on without having looked (baselines, upper bounds, and agents that know the map).
    Unseeing,
    /// Went back to a node where it had been: the sequence of scores was too low, or the text fits another way better.
    Back,
    /// Ended the walk here.
    Stop,
}

/// Why a walk ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// The agent took the place for the goal.
    Stopped,
    /// It had made the most steps that it may.
    Cap,
    /// There was nowhere to go.
    DeadEnd,
    /// It had made the most calls of its model that it may.
    Calls,
    /// Its model had cost what a walk may cost.
    Money,
    /// It took one hop over and over.
    Circles,
    /// Several replies of its model in a row were of no use.
    NoUse,
}

impl From<(f32, f32, usize)> for Scored {
    fn from((phrase, activity, ways): (f32, f32, usize)) -> Self {
        Self { phrase, activity, ways }
    }
}

impl From<Scored> for (f32, f32, usize) {
    fn from(scored: Scored) -> Self {
        (scored.phrase, scored.activity, scored.ways)
    }
}

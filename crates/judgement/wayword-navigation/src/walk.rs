//! What an agent did, step by step.

use crate::directions::Directions;
use serde::{Deserialize, Serialize};
use wayword_core::{Heading, ObjectId, SceneId, ViewpointId};

/// One agent's walk by one instruction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Walk {
    /// Who walked (`clip-nav`, `random/5`).
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
    /// The instruction as the agent took it apart; `None` for one that does not read.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub directions: Option<Directions>,
    /// Every node at which it stood, in order; at least the start.
    pub steps: Vec<Step>,
    /// Why it ended.
    pub end: End,
    /// The object that it takes for the target, where its grounder can name one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<ObjectId>,
}

/// A stand at a node, and what was decided there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// The node.
    pub viewpoint: ViewpointId,
    /// The direction of the hop that led here; at the start the episode's.
    pub heading_rad: Heading,
    /// What was seen and scored. Empty on the way back over nodes, and for agents that look at nothing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub views: Vec<Scored>,
    /// The key phrase in hand when it looked, from 0; beyond the last where only the activity is left.
    #[serde(default)]
    pub phrase: usize,
    /// What it did then.
    pub choice: Choice,
}

/// One of the four views of a step: north, east, south, west. A list of its three values in files, of which there are many.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(from = "(f32, f32, usize)", into = "(f32, f32, usize)")]
pub struct Scored {
    /// How well the key phrase in hand fits it.
    pub phrase: f32,
    /// How well the activity fits it.
    pub activity: f32,
    /// How many neighbours lie in it.
    pub ways: usize,
}

/// What an agent did at a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Choice {
    /// Went on through one of the four views, from 0.
    Onward(usize),
    /// Went on without having looked (floors and ceilings).
    Unseeing,
    /// Went back to the node before, since the sequence of scores was too low.
    Back,
    /// Stayed here for good.
    Stop,
}

/// Why a walk ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// The agent took the place for the goal.
    Stopped,
    /// It had made as many steps as it may.
    Cap,
    /// There was nowhere to go.
    DeadEnd,
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

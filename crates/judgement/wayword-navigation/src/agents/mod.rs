//! Agents that walk by instructions, and the baselines and upper bounds that they are compared with.

mod baselines;
mod map_reader;
mod parameters;
mod phrases;
mod policy;
mod reader;
mod tools;

pub use baselines::{last_room_in, nearest_room, oracle, random, straight};
pub use map_reader::{MapReader, Surveyed};
pub use parameters::{Back, Parameters};
pub use phrases::walk_by_phrases;
pub use reader::walk_by_reading;
pub use tools::{Describes, Limits, Looks, MOST_TEXT_CHARS, ModelWalker, rehearse, walk_by_tools, wording};
pub use wayword_follower::Prior;

use crate::{
    sight::AgentView,
    walk::{Choice, Step},
};
use wayword_core::{Gaze, Heading, SceneId, ViewpointId};

/// Where an agent begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// The scene.
    pub scene: SceneId,
    /// The node.
    pub viewpoint: ViewpointId,
    /// Which way it looks.
    pub heading: Heading,
}

/// The result of a walk.
#[derive(Debug, Clone, PartialEq)]
pub struct Walked {
    /// Every step.
    pub steps: Vec<Step>,
    /// Why it ended.
    pub end: crate::walk::End,
    /// The object that the agent takes for the target.
    pub object: Option<wayword_core::ObjectId>,
    /// Calls, tokens and cost, if a language model decided.
    pub effort: Option<crate::walk::Effort>,
}

/// How a hop is recorded: as a step back if it leads to a node that the agent has visited, and otherwise by the view in which it
/// lies.
fn choice(agent_view: &AgentView<'_>, steps: &[Step], here: &ViewpointId, to: &ViewpointId) -> Choice {
    if steps.iter().any(|step| step.viewpoint == *to) {
        return Choice::Back;
    }
    let heading = agent_view.heading_to(here, to).unwrap_or(Heading::NORTH);
    Gaze::compass().iter().position(|gaze| gaze.holds(heading)).map_or(Choice::Unseeing, Choice::Onward)
}

#[cfg(test)]
mod tests;

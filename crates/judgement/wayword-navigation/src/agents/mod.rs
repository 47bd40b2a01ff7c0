//! Agents that walk by instructions, and the baselines and upper bounds that they are compared with.

mod baselines;
mod map_reader;
mod parameters;
mod phrase_walker;
mod policy;
mod reader;
mod tools;

pub use baselines::{last_room_in, walk_randomly, walk_shortest_path, walk_straight, walk_to_nearest_room};
pub use map_reader::{MapReader, MappedScene};
pub use parameters::{BacktrackParameters, PhraseWalkParameters};
pub use phrase_walker::walk_by_phrases;
pub use reader::walk_by_reading;
pub use tools::{
    MAX_INSTRUCTION_CHARS, ModelWalker, ToolAgentSight, ToolWalkLimits, ViewDescriber, prompt_wording, rehearse_route,
    walk_by_tools,
};
pub use wayword_follower::WalkPrior;

use crate::{
    sight::AgentView,
    walk::{AgentStep, StepChoice},
};
use wayword_core::{Heading, SceneId, ViewGaze, ViewpointId};

/// Where an agent begins.
#[derive(Debug, Clone, PartialEq)]
pub struct AgentStart {
    /// The scene.
    pub scene: SceneId,
    /// The node.
    pub viewpoint: ViewpointId,
    /// Which way it looks.
    pub heading: Heading,
}

/// The result of a walk.
#[derive(Debug, Clone, PartialEq)]
pub struct AgentWalk {
    /// Every step.
    pub steps: Vec<AgentStep>,
    /// Why it ended.
    pub end: crate::walk::WalkEnd,
    /// The object that the agent takes for the target.
    pub object: Option<wayword_core::ObjectId>,
    /// Calls, tokens and cost, if a language model decided.
    pub effort: Option<crate::walk::WalkEffort>,
}

/// How a hop is recorded: as a step back if it leads to a node that the agent has visited, and otherwise by the view in which it
/// lies.
fn choice_for_hop(agent_view: &AgentView<'_>, steps: &[AgentStep], here: &ViewpointId, to: &ViewpointId) -> StepChoice {
    if steps.iter().any(|step| step.viewpoint == *to) {
        return StepChoice::Back;
    }
    let heading = agent_view.heading_to(here, to).unwrap_or(Heading::NORTH);
    ViewGaze::compass_views()
        .iter()
        .position(|gaze| gaze.holds_heading(heading))
        .map_or(StepChoice::Unseeing, StepChoice::Onward)
}

#[cfg(test)]
mod tests;

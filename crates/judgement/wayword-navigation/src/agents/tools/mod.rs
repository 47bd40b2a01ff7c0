//! The agent with a language model: the model looks around and steps from node to node by calling tools (`observe`, `step`, `stop`).
//!
//! Each prompt contains the instruction, a map of the visited nodes, the last steps with their reasons, the model's own note, the
//! ways out of the current node and, after `observe`, the things there. It contains no information about nodes that were not
//! visited. Useless replies are counted and reported back to the model; several in a row end the walk, which is then scored as it
//! is.

mod limits;
mod memory;
mod observed_scene;
mod prompt;
mod rehearsal;
mod tool_calls;
mod walker;

pub use limits::ToolWalkLimits;
pub use observed_scene::{ToolAgentSight, ViewDescriber};
pub use prompt::{MAX_INSTRUCTION_CHARS, prompt_wording};
pub use rehearsal::rehearse_route;

use super::{AgentStart, AgentWalk, choice_for_hop};
use crate::{error::WalkError, sight::AgentView};
use walker::ToolWalker;
use wayword_core::LanguageModel;

/// A language model as an agent.
#[derive(Clone, Copy)]
pub struct ModelWalker<'a> {
    /// The model that decides.
    pub model: &'a dyn LanguageModel,
    /// US dollars of a call by its tokens in and out, for replies without a price; `None` if prices are not known.
    pub price: Option<&'a (dyn Fn(u64, u64) -> f64 + Send + Sync)>,
    /// How it perceives a place: labels, pictures or captions.
    pub looks: ToolAgentSight<'a>,
    /// The limits of a walk.
    pub limits: ToolWalkLimits,
    /// Seed of the model's sampling, for models that accept one.
    pub seed: u64,
}

/// Walks by an instruction as a language model decides. If `names_object`, the model is asked for the object that the
/// instruction means.
///
/// # Errors
/// When the platform gives no view, or lacks the labels or pictures that the model is to see; when the service cannot be reached
/// or answers no more; or when no call got an answer.
pub fn walk_by_tools(
    agent_view: &AgentView<'_>,
    start: &AgentStart,
    text: &str,
    names_object: bool,
    by: ModelWalker<'_>,
) -> Result<AgentWalk, WalkError> {
    let mut walker = ToolWalker::new(agent_view, start, text, names_object, by);
    let end = loop {
        if let Some(end) = walker.exhausted_limit() {
            break end;
        }
        let Some(calls) = walker.ask_model()? else { continue };
        if let Some(end) = walker.carry_out(calls)? {
            break end;
        }
    };
    walker.finish_walk(end)
}

#[cfg(test)]
mod tests;

//! The agent by a language model: it looks around and steps from node to node by calling tools.
//!
//! At each call the model is told its instruction, a map of where it was, its last steps with their reasons, its own
//! note, the ways out of where it stands and, once it has looked around, what is there. It is told nothing of nodes
//! where it did not stand. Replies that are no use are counted, told to the model, and bounded: the walk is scored as it
//! stands.

mod limits;
mod memory;
mod prompt;
mod rehearsal;
mod reply;
mod scene;
mod walker;

pub use limits::Limits;
pub use prompt::{MOST_TEXT_CHARS, wording};
pub use rehearsal::rehearse;
pub use scene::{Describes, Looks};

use super::{Start, Walked, choice};
use crate::{error::WalkError, sight::AgentView};
use walker::Walker;
use wayword_core::LanguageModel;

/// A language model as an agent.
#[derive(Clone, Copy)]
pub struct ModelWalker<'a> {
    /// The model that decides.
    pub model: &'a dyn LanguageModel,
    /// US dollars of a call by its tokens in and out, for replies that do not tell; `None` where that is not known.
    pub price: Option<&'a (dyn Fn(u64, u64) -> f64 + Send + Sync)>,
    /// How it sees.
    pub looks: Looks<'a>,
    /// What a walk may take.
    pub limits: Limits,
    /// Seed of the model's sampling, for models that accept one.
    pub seed: u64,
}

/// Walks by an instruction as a language model decides. Where `names_object`, the model is asked for the object that the
/// instruction means.
///
/// # Errors
/// When the platform gives no view, there is nothing of what the model is to see, its service is lost or answers no
/// more, or it gave no answer at all.
pub fn walk_by_tools(
    agent_view: &AgentView<'_>,
    start: &Start,
    text: &str,
    names_object: bool,
    by: ModelWalker<'_>,
) -> Result<Walked, WalkError> {
    let mut walker = Walker::new(agent_view, start, text, names_object, by);
    let end = loop {
        if let Some(end) = walker.spent() {
            break end;
        }
        let Some(calls) = walker.ask()? else { continue };
        if let Some(end) = walker.act(calls)? {
            break end;
        }
    };
    walker.done(end)
}

#[cfg(test)]
mod tests;

//! Rehearses a walk along a known route without calling a model, to estimate the tokens and the cost of real walks.

use super::{
    ModelWalker, ToolAgentSight, ToolWalkLimits,
    tool_calls::{AgentToolAction, AgentToolCall},
    walker::ToolWalker,
};
use crate::{agents::AgentStart, error::WalkError, sight::AgentView};
use wayword_core::{LanguageModel, ModelError, ModelReply, ModelRequest, ViewpointId};

/// The requests of a walk along a route by a model that looks around at each place, steps on, and stops at the end. No model is
/// called. If the route leaves the graph, the walk ends there.
///
/// # Errors
/// When the platform gives no view, or lacks the labels or pictures that the model is to see.
pub fn rehearse_route(
    agent_view: &AgentView<'_>,
    start: &AgentStart,
    text: &str,
    names_object: bool,
    (looks, limits): (ToolAgentSight<'_>, ToolWalkLimits),
    route: &[ViewpointId],
) -> Result<Vec<ModelRequest>, WalkError> {
    let by = ModelWalker { model: &SilentModel, price: None, looks, limits, seed: 0 };
    let mut walker = ToolWalker::new(agent_view, start, text, names_object, by);
    let call = |act| AgentToolCall { act, why: TYPICAL_REASON.to_owned(), note: Some(TYPICAL_NOTE.to_owned()) };
    let mut requests = vec![walker.next_request()?];
    walker.carry_out(vec![call(AgentToolAction::Observe)])?;
    for to in route.iter().skip(1) {
        requests.push(walker.next_request()?);
        walker.effort.calls += 1;
        let way = walker.ways_out().iter().position(|(way, _)| way == to);
        let Some(way) = way else { return Ok(requests) };
        if walker.carry_out(vec![call(AgentToolAction::Step(Some(way + 1))), call(AgentToolAction::Observe)])?.is_some()
        {
            return Ok(requests);
        }
    }
    requests.push(walker.next_request()?);
    Ok(requests)
}

/// A reason and a note of usual length, so that the rehearsed prompts are as long as those of real walks.
const TYPICAL_REASON: &str = "The instruction says to go past the table, and this way leads past it.";
const TYPICAL_NOTE: &str = "Out of the bedroom and past the table; next: turn left into the kitchen.";

/// A placeholder for the model, which is never called.
struct SilentModel;

impl LanguageModel for SilentModel {
    fn name(&self) -> &'static str {
        "silent"
    }

    fn complete_requests(&self, _: &[ModelRequest]) -> Vec<Result<ModelReply, ModelError>> {
        Vec::new()
    }
}

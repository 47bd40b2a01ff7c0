//! Rehearses a walk along a known route without calling a model, to estimate the tokens and the cost of real walks.

use super::{
    Limits, Looks, ModelWalker,
    reply::{Act, Called},
    walker::Walker,
};
use crate::{agents::Start, error::WalkError, sight::AgentView};
use wayword_core::{LanguageModel, ModelError, Reply, Request, ViewpointId};

/// The requests of a walk along a route by a model that looks around at each place, steps on, and stops at the end. No model is
/// called. If the route leaves the graph, the walk ends there.
///
/// # Errors
/// When the platform gives no view, or lacks the labels or pictures that the model is to see.
pub fn rehearse(
    agent_view: &AgentView<'_>,
    start: &Start,
    text: &str,
    names_object: bool,
    (looks, limits): (Looks<'_>, Limits),
    route: &[ViewpointId],
) -> Result<Vec<Request>, WalkError> {
    let by = ModelWalker { model: &Silent, price: None, looks, limits, seed: 0 };
    let mut walker = Walker::new(agent_view, start, text, names_object, by);
    let call = |act| Called { act, why: TYPICAL_REASON.to_owned(), note: Some(TYPICAL_NOTE.to_owned()) };
    let mut requests = vec![walker.request()?];
    walker.act(vec![call(Act::Observe)])?;
    for to in route.iter().skip(1) {
        requests.push(walker.request()?);
        walker.effort.calls += 1;
        let way = walker.ways().iter().position(|(way, _)| way == to);
        let Some(way) = way else { return Ok(requests) };
        if walker.act(vec![call(Act::Step(Some(way + 1))), call(Act::Observe)])?.is_some() {
            return Ok(requests);
        }
    }
    requests.push(walker.request()?);
    Ok(requests)
}

const TYPICAL_REASON: &str = "The instruction says to go past the table, and this way leads past it.";
const TYPICAL_NOTE: &str = "Out of the bedroom and past the table; next: turn left into the kitchen.";

/// A placeholder for the model, which is never called.
struct Silent;

impl LanguageModel for Silent {
    fn name(&self) -> &'static str {
        "silent"
    }

    fn complete(&self, _: &[Request]) -> Vec<Result<Reply, ModelError>> {
        Vec::new()
    }
}

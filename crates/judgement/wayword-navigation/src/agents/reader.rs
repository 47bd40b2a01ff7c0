//! The agent that reads. It interprets every clause of an instruction and, at each node, goes on with the walks that fit the
//! clauses best (`wayword_follower::online`). It sees only the surroundings of the node where it is.

use super::{AgentStart, AgentWalk, choice_for_hop};
use crate::{
    directions::beginning_of,
    error::WalkError,
    sight::{AgentView, ThingSource},
    walk::{AgentStep, StepChoice, SurroundingsSummary, WalkEnd},
};
use wayword_follower::{
    Guide,
    online::{OnwardWeights, WalkerDecision, WalkerSighting, WalkingFollower},
};

/// Most hops of a walk; a walk that would go on ends as [`WalkEnd::Cap`]. The reader normally stops long before.
const MAX_READER_HOPS: usize = 100;

/// Walks by an instruction, reading all of it. At each node the agent gets only a [`WalkerSighting`].
///
/// # Errors
/// When the platform gives no view, labels are asked for and there are none, or the grounder fails.
pub fn walk_by_reading(
    agent_view: &AgentView<'_>,
    start: &AgentStart,
    text: &str,
    things: &ThingSource,
) -> Result<AgentWalk, WalkError> {
    let guide = Guide::read_text(beginning_of(text));
    let mut reader = WalkingFollower::new(&guide, OnwardWeights::fitted());
    walk_by_decisions(agent_view, start, things, |sighting| reader.decide_next(sighting))
}

/// Walks as `decide` decides, and records the steps.
fn walk_by_decisions(
    agent_view: &AgentView<'_>,
    start: &AgentStart,
    things: &ThingSource,
    mut decide: impl FnMut(&WalkerSighting) -> WalkerDecision,
) -> Result<AgentWalk, WalkError> {
    let mut steps: Vec<AgentStep> = Vec::new();
    let (mut here, mut heading) = (start.viewpoint.clone(), start.heading);
    let end = loop {
        let surroundings = agent_view.surroundings_at(&here, heading, things)?;
        let sighting = &surroundings.sighting;
        let to = match decide(sighting) {
            WalkerDecision::Go(hop) => surroundings.ways.get(hop),
            WalkerDecision::Stop => None,
        };
        let (to, end) = match to {
            Some(_) if steps.len() >= MAX_READER_HOPS => (None, WalkEnd::Cap),
            None if sighting.hops.is_empty() => (None, WalkEnd::DeadEnd),
            to => (to, WalkEnd::Stopped),
        };
        let choice = to.map_or(StepChoice::Stop, |to| choice_for_hop(agent_view, &steps, &here, to));
        let summary = SurroundingsSummary {
            room: sighting.room.clone(),
            ways: sighting.hops.len(),
            things: sighting.things.len(),
        };
        steps.push(AgentStep { told: Some(summary), ..AgentStep::new(here.clone(), heading, choice) });
        let Some(to) = to else { break end };
        heading = agent_view.heading_to(&here, to).unwrap_or(heading);
        here = to.clone();
    };
    Ok(AgentWalk { steps, end, object: None, effort: None })
}

#[cfg(test)]
mod tests;

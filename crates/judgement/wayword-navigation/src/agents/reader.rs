//! The agent that reads. It interprets every clause of an instruction and, at each node, goes on with the walks that fit the
//! clauses best (`wayword_follower::online`). It sees only the surroundings of the node where it is.

use super::{Start, Walked, choice};
use crate::{
    directions::beginning_of,
    error::WalkError,
    sight::{AgentView, Things},
    walk::{Choice, End, Step, Told},
};
use wayword_follower::{
    Guide,
    online::{Decision, OnwardWeights, Reader, Sighting},
};

/// Most hops of a walk. The reader normally stops long before.
const MOST_HOPS: usize = 100;

/// Walks by an instruction, reading all of it. At each node the agent gets only a [`Sighting`].
///
/// # Errors
/// When the platform gives no view, labels are asked for and there are none, or the grounder fails.
pub fn walk_by_reading(
    agent_view: &AgentView<'_>,
    start: &Start,
    text: &str,
    things: &Things,
) -> Result<Walked, WalkError> {
    let guide = Guide::read(beginning_of(text));
    let mut reader = Reader::new(&guide, OnwardWeights::fitted());
    walk(agent_view, start, things, |seen| reader.decide(seen))
}

/// Walks as `decide` decides, and records the steps.
fn walk(
    agent_view: &AgentView<'_>,
    start: &Start,
    things: &Things,
    mut decide: impl FnMut(&Sighting) -> Decision,
) -> Result<Walked, WalkError> {
    let mut steps: Vec<Step> = Vec::new();
    let (mut here, mut heading) = (start.viewpoint.clone(), start.heading);
    let end = loop {
        let told = agent_view.told(&here, heading, things)?;
        let seen = &told.sighting;
        let to = match decide(seen) {
            Decision::Go(hop) => told.ways.get(hop),
            Decision::Stop => None,
        };
        let (to, end) = match to {
            Some(_) if steps.len() >= MOST_HOPS => (None, End::Cap),
            None if seen.hops.is_empty() => (None, End::DeadEnd),
            to => (to, End::Stopped),
        };
        let choice = to.map_or(Choice::Stop, |to| choice(agent_view, &steps, &here, to));
        let told = Told { room: seen.room.clone(), ways: seen.hops.len(), things: seen.things.len() };
        steps.push(Step { told: Some(told), ..Step::new(here.clone(), heading, choice) });
        let Some(to) = to else { break end };
        heading = agent_view.heading_to(&here, to).unwrap_or(heading);
        here = to.clone();
    };
    Ok(Walked { steps, end, object: None, effort: None })
}

#[cfg(test)]
mod tests;

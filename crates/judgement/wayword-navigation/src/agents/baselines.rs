//! Lower bounds, which do not read the instruction (random, straight on), and upper bounds, which know the map or the goal. The
//! figures of an agent are meaningful only between these.

use super::{AgentStart, AgentWalk};
use crate::{
    error::WalkError,
    sight::{frame_at, heading_to},
    walk::{AgentStep, StepChoice, WalkEnd},
};
use rand::{Rng, seq::IndexedRandom};
use wayword_core::{Heading, Platform, ViewGaze, ViewpointGraph, ViewpointId};
use wayword_language::lexicon::same_room;

/// `hops` hops, each to a random neighbour, all equally likely.
#[must_use]
pub fn walk_randomly(graph: &ViewpointGraph, start: &AgentStart, hops: usize, rng: &mut impl Rng) -> AgentWalk {
    follow_nodes(graph, start, hops, |here, _| graph.neighbours_of(here).choose(rng).map(|to| (*to).clone()))
}

/// Up to `hops` hops, each to the neighbour nearest to straight ahead, as long as one lies in the quarter ahead.
#[must_use]
pub fn walk_straight(graph: &ViewpointGraph, start: &AgentStart, hops: usize) -> AgentWalk {
    follow_nodes(graph, start, hops, |here, heading| {
        let ahead = ViewGaze::quarter_view(heading);
        let bearing = |to: &ViewpointId| heading_to(graph, here, to).filter(|to| ahead.holds_heading(*to));
        let off_rad = |to: Heading| heading.turn_to(to).abs();
        let near = graph.neighbours_of(here).into_iter().filter_map(|to| Some((off_rad(bearing(to)?), to)));
        near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, to)| to.clone())
    })
}

/// The shortest path to the annotated goal; only the start if there is no way.
///
/// # Errors
/// When the start or the goal is not in the graph.
pub fn walk_shortest_path(
    graph: &ViewpointGraph,
    start: &AgentStart,
    goal: &ViewpointId,
) -> Result<AgentWalk, WalkError> {
    shortest_walk(graph, start, goal)
}

/// The shortest path to the nearest node of a room, by the platform's labels; only the start if there is none. This agent knows the
/// map and every room, and uses only the room's name from the instruction.
///
/// # Errors
/// When the platform gives no view.
pub fn walk_to_nearest_room(
    platform: &dyn Platform,
    start: &AgentStart,
    wanted: Option<&str>,
) -> Result<AgentWalk, WalkError> {
    let graph = platform.graph_for_scene(&start.scene)?;
    let distances = graph.distances_from(&start.viewpoint).map_err(|_| unknown_viewpoint(start, &start.viewpoint))?;
    let mut near: Vec<(&ViewpointId, f64)> = distances.into_iter().collect();
    near.sort_by(|a, b| a.1.total_cmp(&b.1).then_with(|| a.0.cmp(b.0)));
    for (viewpoint, _) in near {
        let frame = frame_at(&graph, &start.scene, viewpoint)?;
        let view = platform.look_without_picture(&start.scene, &frame, ViewGaze::quarter_view(Heading::NORTH))?;
        let room = view.ground_truth().and_then(|truth| truth.room.as_deref());
        if room.zip(wanted).is_some_and(|(room, wanted)| same_room(room, wanted)) {
            return shortest_walk(&graph, start, viewpoint);
        }
    }
    Ok(follow_nodes(&graph, start, 0, |_, _| None))
}

fn unknown_viewpoint(start: &AgentStart, viewpoint: &ViewpointId) -> WalkError {
    WalkError::Unknown { scene: start.scene.clone(), viewpoint: viewpoint.clone() }
}

fn shortest_walk(graph: &ViewpointGraph, start: &AgentStart, goal: &ViewpointId) -> Result<AgentWalk, WalkError> {
    let route = graph.shortest_path(&start.viewpoint, goal).map_err(|_| unknown_viewpoint(start, goal))?;
    let mut rest = route.map(|route| route.viewpoints).unwrap_or_default().into_iter().skip(1);
    Ok(follow_nodes(graph, start, usize::MAX, |_, _| rest.next()))
}

/// Follows `next`, which gets a node and the heading there and gives the next node, until it gives none or `hops` hops are made.
pub(super) fn follow_nodes(
    graph: &ViewpointGraph,
    start: &AgentStart,
    hops: usize,
    mut next: impl FnMut(&ViewpointId, Heading) -> Option<ViewpointId>,
) -> AgentWalk {
    let mut steps = Vec::new();
    let (mut here, mut heading) = (start.viewpoint.clone(), start.heading);
    while let Some(to) = (steps.len() < hops).then(|| next(&here, heading)).flatten() {
        let onward = heading_to(graph, &here, &to).unwrap_or(heading);
        steps.push(AgentStep::new(here, heading, StepChoice::Unseeing));
        (here, heading) = (to, onward);
    }
    steps.push(AgentStep::new(here, heading, StepChoice::Stop));
    AgentWalk { steps, end: WalkEnd::Stopped, object: None, effort: None }
}

/// The room that an instruction names last: the rooms before it are left or passed.
#[must_use]
pub fn last_room_in(text: &str) -> Option<String> {
    let rooms = crate::directions::named_places(text).into_iter().filter(|place| place.is_room);
    rooms.map(|place| place.name).next_back()
}

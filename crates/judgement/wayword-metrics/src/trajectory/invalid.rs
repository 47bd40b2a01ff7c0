//! What makes a trajectory none of its episode.

use super::{Demand, Distances, Trajectory};
use wayword_core::ViewpointId;

/// Something that makes a trajectory none of its episode.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Invalid {
    /// It has no viewpoint.
    #[error("the trajectory is empty")]
    Empty,
    /// The scene has no such viewpoint.
    #[error("step {step}: the scene has no viewpoint {viewpoint}")]
    Unknown {
        /// Its place in the trajectory, from 0.
        step: usize,
        /// Which.
        viewpoint: ViewpointId,
    },
    /// It begins elsewhere.
    #[error("it starts at {found} and not at the episode's start {expected}")]
    Start {
        /// Where it begins.
        found: ViewpointId,
        /// Where the episode does.
        expected: ViewpointId,
    },
    /// A hop that is neither an edge nor a stay.
    #[error("step {step}: there is no edge from {from} to {to}")]
    NoEdge {
        /// The place in the trajectory, from 0, that is hopped to.
        step: usize,
        /// From there.
        from: ViewpointId,
        /// To there.
        to: ViewpointId,
    },
}

/// Everything that makes a trajectory none of its episode; empty where it is one.
#[must_use]
pub fn problems(distances: &Distances, demand: &Demand, trajectory: &Trajectory) -> Vec<Invalid> {
    let stood = &trajectory.viewpoints;
    let (Some(found), Some(expected)) = (stood.first(), demand.reference.first()) else { return vec![Invalid::Empty] };
    let mut problems = Vec::new();
    if found != expected {
        problems.push(Invalid::Start { found: found.clone(), expected: expected.clone() });
    }
    for (step, viewpoint) in stood.iter().enumerate() {
        if !distances.has(viewpoint) {
            problems.push(Invalid::Unknown { step, viewpoint: viewpoint.clone() });
        } else if let Some(from) = step.checked_sub(1).map(|before| &stood[before]) {
            let goes = from == viewpoint || distances.has_edge(from, viewpoint);
            if !goes && distances.has(from) {
                problems.push(Invalid::NoEdge { step, from: from.clone(), to: viewpoint.clone() });
            }
        }
    }
    problems
}

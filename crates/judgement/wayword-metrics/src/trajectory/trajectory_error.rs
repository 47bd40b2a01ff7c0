//! Checks a trajectory and its episode, and lists every problem that makes scoring impossible.

use super::{AgentTrajectory, EpisodeDemand, SceneDistances};
use wayword_core::ViewpointId;

/// A problem of a trajectory or of its episode that makes scoring impossible. Steps count from 0, the start.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TrajectoryError {
    /// The trajectory contains no viewpoint.
    #[error("the trajectory is empty: list its viewpoints from the start on, or only the start if the agent stays")]
    Empty,
    /// The trajectory does not start where its episode does.
    #[error("the trajectory starts at {found}: it has to start where its episode does, at {expected}")]
    Start {
        /// Its first viewpoint.
        found: String,
        /// The first viewpoint of the episode's path.
        expected: ViewpointId,
    },
    /// A viewpoint that the scene does not have.
    #[error(
        "viewpoint {viewpoint} (step {step} of the trajectory) is not in the scene's viewpoint graph: check that the trajectory, the episodes and the viewpoint graph are of the same release"
    )]
    Unknown {
        /// Its step.
        step: usize,
        /// Its name, as it was given.
        viewpoint: String,
    },
    /// Two viewpoints in a row that are neither the same nor joined.
    #[error(
        "there is no edge from {from} to {to} (step {step} of the trajectory): list every viewpoint that is passed"
    )]
    NoEdge {
        /// The step of the second one.
        step: usize,
        /// The first one.
        from: ViewpointId,
        /// The second one.
        to: ViewpointId,
    },
    /// An episode without a path.
    #[error("the episode has no annotated path to compare the trajectory with")]
    NoReference,
    /// A viewpoint of the episode's path that the scene does not have.
    #[error(
        "viewpoint {viewpoint} (step {step} of the episode's path) is not in the scene's viewpoint graph: check that the episodes and the viewpoint graph are of the same release"
    )]
    UnknownInReference {
        /// Its step.
        step: usize,
        /// Its name.
        viewpoint: ViewpointId,
    },
}

/// All problems that make it impossible to score a trajectory; empty if it can be scored.
#[must_use]
pub fn find_problems(
    distances: &SceneDistances,
    demand: &EpisodeDemand,
    trajectory: &AgentTrajectory,
) -> Vec<TrajectoryError> {
    let mut problems = reference_places(distances, demand).err().unwrap_or_default();
    let names = trajectory.viewpoints.iter().map(ViewpointId::as_str);
    let start = demand.reference.first().and_then(|start| distances.place_number(start.as_str()));
    problems.extend(trajectory_places(distances, start, names).err().into_iter().flatten());
    problems
}

/// The places (numbers of viewpoints) of the annotated path; never empty.
pub(super) fn reference_places(
    distances: &SceneDistances,
    demand: &EpisodeDemand,
) -> Result<Vec<usize>, Vec<TrajectoryError>> {
    if demand.reference.is_empty() {
        return Err(vec![TrajectoryError::NoReference]);
    }
    let mut problems = Vec::new();
    let mut places = Vec::with_capacity(demand.reference.len());
    for (step, viewpoint) in demand.reference.iter().enumerate() {
        match distances.place_number(viewpoint.as_str()) {
            Some(place) => places.push(place),
            None => problems.push(TrajectoryError::UnknownInReference { step, viewpoint: viewpoint.clone() }),
        }
    }
    if problems.is_empty() { Ok(places) } else { Err(problems) }
}

/// The places of a trajectory; never empty, and the first is `start`, where that is known.
pub(super) fn trajectory_places<'n>(
    distances: &SceneDistances,
    start: Option<usize>,
    names: impl Iterator<Item = &'n str> + Clone,
) -> Result<Vec<usize>, Vec<TrajectoryError>> {
    let places: Vec<usize> = names.clone().map(|name| distances.place_number(name).unwrap_or(UNKNOWN_PLACE)).collect();
    let starts_right = match (places.first(), start) {
        (Some(first), Some(start)) => *first == start,
        (first, _) => first.is_some(),
    };
    let is_broken = |hop: &[usize]| hop[0] != hop[1] && !distances.are_joined(hop[0], hop[1]);
    if starts_right && !places.contains(&UNKNOWN_PLACE) && !places.windows(2).any(is_broken) {
        return Ok(places);
    }
    Err(list_problems(distances, start, &places, &names.collect::<Vec<_>>()))
}

/// Every problem of a trajectory.
fn list_problems(
    distances: &SceneDistances,
    start: Option<usize>,
    places: &[usize],
    names: &[&str],
) -> Vec<TrajectoryError> {
    let unknown = places.iter().zip(names).enumerate().filter(|(_, (place, _))| **place == UNKNOWN_PLACE);
    let mut problems: Vec<TrajectoryError> =
        unknown.map(|(step, (_, name))| TrajectoryError::Unknown { step, viewpoint: (*name).to_owned() }).collect();
    match (places.iter().zip(names).next(), start) {
        (None, _) => problems.push(TrajectoryError::Empty),
        (Some((first, found)), Some(start)) if *first != start => {
            problems.push(TrajectoryError::Start {
                found: (*found).to_owned(),
                expected: distances.place_name(start).clone(),
            });
        }
        _ => {}
    }
    for (at, hop) in places.windows(2).enumerate() {
        // Unknown viewpoints are already in the list, so their hops are not reported again.
        let is_reported = hop.contains(&UNKNOWN_PLACE);
        if !is_reported && hop[0] != hop[1] && !distances.are_joined(hop[0], hop[1]) {
            let [from, to] = [hop[0], hop[1]].map(|place| distances.place_name(place).clone());
            problems.push(TrajectoryError::NoEdge { step: at + 1, from, to });
        }
    }
    problems
}

/// Marks a viewpoint that the scene does not have. No real place has this number, and the mark is used only within this file.
const UNKNOWN_PLACE: usize = usize::MAX;

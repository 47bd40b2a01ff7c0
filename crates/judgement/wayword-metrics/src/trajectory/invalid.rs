//! What keeps a trajectory from being scored.

use super::{Demand, Distances, Trajectory};
use wayword_core::ViewpointId;

/// A problem of a trajectory, or of its demand, that keeps it from being scored. Steps count from 0, the start.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Invalid {
    /// It holds no viewpoint.
    #[error("the trajectory is empty: list its viewpoints from the start on, or only the start if the agent stays")]
    Empty,
    /// It does not start where its episode does.
    #[error("the trajectory starts at {found}: it has to start where its episode does, at {expected}")]
    Start {
        /// Its first viewpoint.
        found: ViewpointId,
        /// The episode's.
        expected: ViewpointId,
    },
    /// A viewpoint that the scene does not have.
    #[error(
        "viewpoint {viewpoint} (step {step} of the trajectory) is not in the scene's viewpoint graph: check that the trajectory, the episodes and the viewpoint graph are of the same release"
    )]
    Unknown {
        /// Its step.
        step: usize,
        /// Its name.
        viewpoint: ViewpointId,
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

/// All that keeps a trajectory from being scored; empty where nothing does.
#[must_use]
pub fn problems(distances: &Distances, demand: &Demand, trajectory: &Trajectory) -> Vec<Invalid> {
    Located::new(distances, demand, trajectory).err().unwrap_or_default()
}

/// A trajectory and the path that is demanded, as places of the scene.
pub(super) struct Located {
    /// The places of the trajectory; never empty.
    pub(super) taken: Vec<usize>,
    /// The annotated path; never empty, and its start is that of `taken`.
    pub(super) reference: Vec<usize>,
}

impl Located {
    pub(super) fn new(distances: &Distances, demand: &Demand, trajectory: &Trajectory) -> Result<Self, Vec<Invalid>> {
        let mut wrong = Vec::new();
        let taken = places(distances, &trajectory.viewpoints, &mut wrong, |step, viewpoint| Invalid::Unknown {
            step,
            viewpoint,
        });
        let reference = places(distances, &demand.reference, &mut wrong, |step, viewpoint| {
            Invalid::UnknownInReference { step, viewpoint }
        });
        match (trajectory.viewpoints.first(), demand.reference.first()) {
            (Some(found), Some(start)) if found != start => {
                wrong.push(Invalid::Start { found: found.clone(), expected: start.clone() });
            }
            (found, start) => {
                wrong.extend(found.is_none().then_some(Invalid::Empty));
                wrong.extend(start.is_none().then_some(Invalid::NoReference));
            }
        }
        for (at, hop) in taken.windows(2).enumerate() {
            // An unknown viewpoint is reported above; its hops would add nothing.
            let is_told = hop.contains(&NOWHERE);
            if !is_told && hop[0] != hop[1] && !distances.joins(hop[0], hop[1]) {
                let [from, to] = [at, at + 1].map(|step| trajectory.viewpoints[step].clone());
                wrong.push(Invalid::NoEdge { step: at + 1, from, to });
            }
        }
        if wrong.is_empty() { Ok(Self { taken, reference }) } else { Err(wrong) }
    }
}

/// The place of a viewpoint that the scene does not have. No real place has this number, and none of these leaves this
/// file.
const NOWHERE: usize = usize::MAX;

fn places(
    distances: &Distances,
    viewpoints: &[ViewpointId],
    wrong: &mut Vec<Invalid>,
    unknown: impl Fn(usize, ViewpointId) -> Invalid,
) -> Vec<usize> {
    let place = |(step, viewpoint): (usize, &ViewpointId)| {
        distances.place(viewpoint).unwrap_or_else(|| {
            wrong.push(unknown(step, viewpoint.clone()));
            NOWHERE
        })
    };
    viewpoints.iter().enumerate().map(place).collect()
}

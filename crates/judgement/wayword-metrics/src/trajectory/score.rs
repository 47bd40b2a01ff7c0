//! Scores one trajectory, and defines what the figures are in cases that the reference implementations leave open.

use super::{
    AgentTrajectory, EpisodeDemand, EpisodeScorer, SceneDistances, TrajectoryError, TrajectoryScore, find_problems,
};
use wayword_core::{ObjectId, ViewpointId};

/// The figures of a trajectory, or all problems that make it impossible to score.
///
/// SR, OSR, NE, TL and SPL by distance are R2R's (`tasks/R2R/eval.py`; SPL as Anderson et al. 2018 define it), SR, OSR,
/// SPL by visibility, RGS and RGSPL are REVERIE's (`tasks/REVERIE/eval_release.py`), nDTW, SDTW and CLS are those of
/// VLN-DUET (`map_nav_src/r2r/eval_utils.py`). Cases that they leave open are decided as follows:
///
/// - The start is the goal and the agent stays: the references divide zero by zero; here the SPL is 1. An agent that moves
///   although the start is the goal has SPL 0, as in the references.
/// - The goal cannot be reached from the start: the references fail; here there are no errors, no success by distance,
///   and every SPL and RGSPL is 0, because there is no shortest path.
/// - Neither the annotated path nor the trajectory moves: CLS divides zero by zero in the reference; here it is 1. An
///   annotated path with a hop that cannot be made has nDTW and CLS 0.
/// - The same viewpoint twice in a row is a stay: it adds no length, and to nDTW what any other viewpoint adds.
///
/// # Errors
/// Each problem of the trajectory, when it does not start at the episode's start, or does not follow the edges of the
/// scene's graph.
pub fn score_trajectory(
    distances: &SceneDistances,
    demand: &EpisodeDemand,
    trajectory: &AgentTrajectory,
) -> Result<TrajectoryScore, Vec<TrajectoryError>> {
    let names = trajectory.viewpoints.iter().map(ViewpointId::as_str);
    let object = trajectory.object.as_ref().map(ObjectId::as_str);
    match EpisodeScorer::new(distances, demand) {
        Ok(scorer) => scorer.score_trajectory(distances, names, object),
        // The episode has problems. Report those of the trajectory as well.
        Err(_) => Err(find_problems(distances, demand, trajectory)),
    }
}

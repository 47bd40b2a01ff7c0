//! The figures of one trajectory.

use super::{
    Demand, Distances, Grounding, Outcome, Score, Trajectory,
    fidelity::{coverage_weighted_by_length, normalised_warping},
    invalid::{Invalid, problems},
};
use wayword_core::ViewpointId;

/// Under this distance from the goal, strictly, a trajectory has arrived, metres (R2R, `tasks/R2R/eval.py`, `error_margin`).
pub(super) const ARRIVED_M: f64 = 3.0;

/// Scores a trajectory by what its episode demands.
///
/// Success, lengths and errors are those of R2R's `tasks/R2R/eval.py` and REVERIE's `tasks/REVERIE/eval_release.py`; nDTW, SDTW and
/// CLS those of VLN-DUET's `map_nav_src/r2r/eval_utils.py`. Where these divide zero by zero, a success counts 1: a trajectory that
/// stays where its goal is has gone the shortest way. A goal that cannot be reached is never reached, and has no error.
///
/// # Errors
/// Everything that makes the trajectory none of its episode.
pub fn score(distances: &Distances, demand: &Demand, trajectory: &Trajectory) -> Result<Score, Vec<Invalid>> {
    let problems = problems(distances, demand, trajectory);
    let (Some(start), Some(goal), true) = (demand.reference.first(), demand.reference.last(), problems.is_empty())
    else {
        return Err(problems);
    };
    let stood = &trajectory.viewpoints;
    let length_m = length_m(distances, stood);
    let shortest_m = distances.metres(start, goal);
    let to_goal = |at: &ViewpointId| distances.metres(at, goal);
    let navigation_error_m = stood.last().and_then(to_goal);
    let oracle_error_m = stood.iter().filter_map(to_goal).min_by(f64::total_cmp);
    let weight =
        shortest_m.map_or(0.0, |shortest_m| if length_m > 0.0 { shortest_m / length_m.max(shortest_m) } else { 1.0 });
    let ndtw = normalised_warping(distances, stood, &demand.reference);
    let outcome = |success: bool, oracle_success: bool| Outcome {
        success,
        oracle_success,
        spl: if success { weight } else { 0.0 },
        sdtw: if success { ndtw } else { 0.0 },
    };
    let arrived = |error_m: Option<f64>| error_m.is_some_and(|error_m| error_m < ARRIVED_M);
    let visible = demand.visible_from.as_ref().map(|from| {
        let sees = |at: &ViewpointId| from.contains(at);
        outcome(stood.last().is_some_and(sees), stood.iter().any(sees))
    });
    let grounding = demand.object.as_ref().map(|object| {
        let rgs = trajectory.object.as_ref() == Some(object);
        Grounding { rgs, rgspl: if rgs { weight } else { 0.0 } }
    });
    Ok(Score {
        length_m,
        navigation_error_m,
        oracle_error_m,
        distance: outcome(arrived(navigation_error_m), arrived(oracle_error_m)),
        visible,
        grounding,
        ndtw,
        cls: coverage_weighted_by_length(distances, stood, &demand.reference),
    })
}

/// The length of a trajectory: the sum of the distances between its nodes.
pub(super) fn length_m(distances: &Distances, viewpoints: &[ViewpointId]) -> f64 {
    viewpoints.windows(2).filter_map(|pair| distances.metres(&pair[0], &pair[1])).sum()
}

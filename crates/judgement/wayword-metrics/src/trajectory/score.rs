//! The figures of one trajectory.

use super::{
    Demand, Distances, Grounding, Outcome, Score, Trajectory,
    fidelity::Apart,
    invalid::{Invalid, Located},
};
use wayword_core::ViewpointId;

/// Nearer to the goal than this, strictly, is a success (R2R, `tasks/R2R/eval.py`, `error_margin`).
const SUCCESS_M: f64 = 3.0;

/// The figures of a trajectory, or all that keeps it from having any.
///
/// SR, OSR, NE, TL and SPL by distance are R2R's (`tasks/R2R/eval.py`; SPL as Anderson et al. 2018 define it), SR, OSR,
/// SPL by visibility, RGS and RGSPL are REVERIE's (`tasks/REVERIE/eval_release.py`), nDTW, SDTW and CLS are those of
/// VLN-DUET (`map_nav_src/r2r/eval_utils.py`). Where they leave a case open:
///
/// - The start is the goal and the agent stays: the references divide zero by zero; here such a success weighs 1. An
///   agent that moves although the start is the goal has SPL 0, as there.
/// - The goal cannot be reached from the start: the references fail; here there are no errors, no success by distance,
///   and every SPL and RGSPL is 0, because there is no shortest path.
/// - Neither the annotated path nor the trajectory moves: CLS divides zero by zero in the reference; here it is 1. An
///   annotated path with a hop that cannot be made has nDTW and CLS 0.
/// - The same viewpoint twice in a row is a stay: it adds no length, and to nDTW what any other viewpoint adds.
///
/// # Errors
/// Each problem of the trajectory, when it does not start at the episode's start, or does not follow the edges of the
/// scene's graph.
pub fn score(distances: &Distances, demand: &Demand, trajectory: &Trajectory) -> Result<Score, Vec<Invalid>> {
    let located = Located::new(distances, demand, trajectory)?;
    let apart = Apart::new(distances, &located);
    let [length_m, path_m] = [&located.taken, &located.reference].map(|places| length_m(distances, places));
    let weight = efficiency(apart.to_goal_m().next().unwrap_or(f64::INFINITY), length_m);
    let ndtw = apart.ndtw();
    let outcome = |success, oracle_success| Outcome {
        success,
        oracle_success,
        spl: if success { weight } else { 0.0 },
        sdtw: if success { ndtw } else { 0.0 },
    };

    let error_m = apart.to_goal_m().last().unwrap_or(f64::INFINITY);
    let oracle_m = apart.to_goal_m().fold(f64::INFINITY, f64::min);
    let visible = demand.object.as_ref().and(demand.visible_from.as_ref()).map(|from| {
        let sees = |viewpoint: &ViewpointId| from.contains(viewpoint);
        outcome(trajectory.viewpoints.last().is_some_and(sees), trajectory.viewpoints.iter().any(sees))
    });
    let grounding = demand.object.as_ref().map(|object| {
        let rgs = trajectory.object.as_ref() == Some(object);
        Grounding { rgs, rgspl: if rgs { weight } else { 0.0 } }
    });
    Ok(Score {
        length_m,
        navigation_error_m: error_m.is_finite().then_some(error_m),
        oracle_error_m: oracle_m.is_finite().then_some(oracle_m),
        distance: outcome(error_m < SUCCESS_M, oracle_m < SUCCESS_M),
        visible,
        grounding,
        ndtw,
        cls: apart.cls(length_m, path_m),
    })
}

/// Sum of the distances between places in a row, metres.
fn length_m(distances: &Distances, places: &[usize]) -> f64 {
    places.windows(2).map(|hop| distances.between(hop[0], hop[1])).sum()
}

/// The shortest length as a share of the length that was walked, at most 1.
fn efficiency(shortest_m: f64, length_m: f64) -> f64 {
    let longer_m = shortest_m.max(length_m);
    if longer_m.is_infinite() {
        0.0
    } else if longer_m == 0.0 {
        1.0
    } else {
        shortest_m / longer_m
    }
}

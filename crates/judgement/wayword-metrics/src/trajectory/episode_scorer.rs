//! Scores many trajectories by one episode. Everything that does not depend on the trajectory, as the length of the shortest path, is
//! computed once.

use super::{
    EpisodeDemand, SceneDistances, SuccessOutcome, TargetGrounding, TrajectoryScore,
    fidelity::PathDistances,
    trajectory_error::{TrajectoryError, reference_places, trajectory_places},
};
use std::collections::BTreeSet;
use wayword_core::{ObjectId, ViewpointId};

/// A trajectory that ends strictly nearer to the goal than this is a success (R2R, `tasks/R2R/eval.py`, `error_margin`).
const SUCCESS_M: f64 = 3.0;

/// An episode's demand, prepared for scoring many trajectories.
#[derive(Debug, Clone)]
pub struct EpisodeScorer {
    start: usize,
    /// The annotated path, by places (numbers of viewpoints); never empty.
    path: Vec<usize>,
    /// The length of the annotated path.
    path_m: f64,
    /// From the start to the goal; infinite where there is no way.
    shortest_m: f64,
    object: Option<ObjectId>,
    /// The places from which the object can be seen, in order.
    visible_from: Option<Vec<usize>>,
}

impl EpisodeScorer {
    /// Prepares a demand. `distances` are those of its scene.
    ///
    /// # Errors
    /// Each problem of the annotated path.
    pub fn new(distances: &SceneDistances, demand: &EpisodeDemand) -> Result<Self, Vec<TrajectoryError>> {
        let path = reference_places(distances, demand)?;
        let ([start, .., goal] | [start @ goal]) = path[..] else { return Err(vec![TrajectoryError::NoReference]) };
        let visible_from = demand.visible_from.as_ref().filter(|_| demand.object.is_some());
        let places = |viewpoints: &BTreeSet<ViewpointId>| {
            // Places are numbered in the order of their names, so these are in order too.
            viewpoints.iter().filter_map(|viewpoint| distances.place_number(viewpoint.as_str())).collect()
        };
        Ok(Self {
            start,
            path_m: length_m(distances, &path),
            shortest_m: distances.metres_between_places(start, goal),
            object: demand.object.clone(),
            visible_from: visible_from.map(places),
            path,
        })
    }

    /// The figures of a trajectory, as [`score_trajectory`](super::score_trajectory) gives them. `names` are its viewpoints, `object` is
    /// the object that the agent names, and `distances` must be those that were given to [`EpisodeScorer::new`].
    ///
    /// # Errors
    /// Each problem of the trajectory.
    pub fn score_trajectory<'n>(
        &self,
        distances: &SceneDistances,
        names: impl Iterator<Item = &'n str> + Clone,
        object: Option<&str>,
    ) -> Result<TrajectoryScore, Vec<TrajectoryError>> {
        let taken = trajectory_places(distances, Some(self.start), names)?;
        let path_distances = PathDistances::new(distances, &taken, &self.path);
        let length_m = length_m(distances, &taken);
        let efficiency = path_efficiency(self.shortest_m, length_m);
        let ndtw = path_distances.ndtw();
        let outcome = |success, oracle_success| SuccessOutcome {
            success,
            oracle_success,
            spl: if success { efficiency } else { 0.0 },
            sdtw: if success { ndtw } else { 0.0 },
        };
        let error_m = path_distances.to_goal_m().last().unwrap_or(f64::INFINITY);
        let oracle_m = path_distances.to_goal_m().fold(f64::INFINITY, f64::min);
        let visible = self.visible_from.as_ref().map(|visible_from| {
            let sees = |place: &usize| visible_from.binary_search(place).is_ok();
            outcome(taken.last().is_some_and(sees), taken.iter().any(sees))
        });
        let grounding = self.object.as_ref().map(|target| {
            let rgs = object == Some(target.as_str());
            TargetGrounding { rgs, rgspl: if rgs { efficiency } else { 0.0 } }
        });
        Ok(TrajectoryScore {
            length_m,
            navigation_error_m: error_m.is_finite().then_some(error_m),
            oracle_error_m: oracle_m.is_finite().then_some(oracle_m),
            distance: outcome(error_m < SUCCESS_M, oracle_m < SUCCESS_M),
            visible,
            grounding,
            ndtw,
            cls: path_distances.cls(length_m, self.path_m),
        })
    }
}

/// Sum of the distances between places in a row, metres.
fn length_m(distances: &SceneDistances, places: &[usize]) -> f64 {
    places.windows(2).map(|hop| distances.metres_between_places(hop[0], hop[1])).sum()
}

/// The shortest length as a share of the length that was walked, at most 1.
fn path_efficiency(shortest_m: f64, length_m: f64) -> f64 {
    let longer_m = shortest_m.max(length_m);
    if longer_m.is_infinite() {
        0.0
    } else if longer_m == 0.0 {
        1.0
    } else {
        shortest_m / longer_m
    }
}

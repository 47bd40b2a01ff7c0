//! How closely a trajectory follows the annotated path: nDTW (normalised dynamic time warping) and CLS (coverage weighted by length
//! score).

use super::SceneDistances;

/// The scale for distances from the path, metres: `threshold` in VLN-DUET's `map_nav_src/r2r/eval_utils.py`.
const THRESHOLD_M: f64 = 3.0;

/// The matrix of distances between the viewpoints of a trajectory (rows) and of the annotated path (columns). All figures except
/// lengths are computed from it.
pub(super) struct PathDistances {
    /// Metres, infinite where there is no way; a row for each viewpoint of the trajectory.
    metres: Vec<f64>,
    /// The number of viewpoints of the annotated path.
    path_viewpoint_count: usize,
}

impl PathDistances {
    /// The distances between the places of a trajectory and those of the annotated path, which has at least one.
    pub(super) fn new(distances: &SceneDistances, trajectory_places: &[usize], path_places: &[usize]) -> Self {
        let mut metres = Vec::with_capacity(trajectory_places.len() * path_places.len());
        for place in trajectory_places {
            metres.extend(path_places.iter().map(|other| distances.metres_between_places(*place, *other)));
        }
        Self { metres, path_viewpoint_count: path_places.len() }
    }

    /// The row of each viewpoint of the trajectory.
    fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.metres.chunks_exact(self.path_viewpoint_count)
    }

    /// The distance from each viewpoint of the trajectory to the goal, metres.
    pub(super) fn to_goal_m(&self) -> impl Iterator<Item = f64> {
        self.rows().map(|row| row[row.len() - 1])
    }

    /// Normalised dynamic time warping (Ilharco et al. 2019, arXiv 1907.05446).
    pub(super) fn ndtw(&self) -> f64 {
        // `costs[n]` is the least cost of aligning the viewpoints so far with the first n + 1 of the path. `before_all` is the
        // cost of aligning them with none: 0 at first, impossible after the first viewpoint.
        let mut costs = vec![f64::INFINITY; self.path_viewpoint_count];
        let mut before_all = 0.0;
        for row in self.rows() {
            let mut diagonal = std::mem::replace(&mut before_all, f64::INFINITY);
            let mut left = f64::INFINITY;
            for (cost, metres) in costs.iter_mut().zip(row) {
                left = metres + lesser_distance(lesser_distance(diagonal, *cost), left);
                diagonal = std::mem::replace(cost, left);
            }
        }
        (-costs[self.path_viewpoint_count - 1] / (THRESHOLD_M * self.path_viewpoint_count as f64)).exp()
    }

    /// Coverage weighted by length score (Jain et al. 2019, arXiv 1905.12255), for the lengths of the trajectory and of the path.
    pub(super) fn cls(&self, length_m: f64, path_m: f64) -> f64 {
        // A column of the matrix: from each viewpoint of the trajectory to one of the path.
        let column_m = |at: usize| self.metres[at..].iter().step_by(self.path_viewpoint_count);
        let nearest_m = |at| column_m(at).copied().fold(f64::INFINITY, lesser_distance);
        let covered: f64 = (0..self.path_viewpoint_count).map(|at| (-nearest_m(at) / THRESHOLD_M).exp()).sum();
        let coverage = covered / self.path_viewpoint_count as f64;
        let expected_m = coverage * path_m;
        let off_m = (expected_m - length_m).abs();
        // Without a way along the path, no length can be expected.
        if expected_m.is_infinite() {
            0.0
        } else if expected_m + off_m == 0.0 {
            coverage
        } else {
            coverage * expected_m / (expected_m + off_m)
        }
    }
}

/// The lesser of two distances. Unlike `f64::min` it does not handle NaN, which distances never are; so it compiles to one
/// instruction instead of three.
fn lesser_distance(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

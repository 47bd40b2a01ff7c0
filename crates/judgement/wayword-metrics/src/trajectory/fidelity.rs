//! How closely a trajectory keeps to the annotated path. Both are places of a scene, never empty.

use super::Distances;

/// What distances from the path are measured by, metres: `threshold` in VLN-DUET's `map_nav_src/r2r/eval_utils.py`.
const THRESHOLD_M: f64 = 3.0;

/// Sum of the distances between places in a row, metres.
pub(super) fn length_m(distances: &Distances, places: &[usize]) -> f64 {
    places.windows(2).map(|hop| distances.between(hop[0], hop[1])).sum()
}

/// Normalised dynamic time warping (Ilharco et al. 2019, section 3).
pub(super) fn ndtw(distances: &Distances, taken: &[usize], reference: &[usize]) -> f64 {
    // The least cost of warping what was taken so far onto each start of the path; the empty start comes first.
    let mut costs = vec![f64::INFINITY; reference.len() + 1];
    costs[0] = 0.0;
    for place in taken {
        let mut diagonal = costs[0];
        costs[0] = f64::INFINITY;
        for (at, on_path) in reference.iter().enumerate() {
            let before = diagonal.min(costs[at]).min(costs[at + 1]);
            diagonal = costs[at + 1];
            costs[at + 1] = before + distances.between(*place, *on_path);
        }
    }
    (-costs[reference.len()] / (THRESHOLD_M * reference.len() as f64)).exp()
}

/// Coverage weighted by length score (Jain et al. 2019, section 4).
pub(super) fn cls(distances: &Distances, taken: &[usize], reference: &[usize]) -> f64 {
    let nearest_m = |on_path: &usize| {
        // From the path to the trajectory, as the reference has it.
        taken.iter().map(|place| distances.between(*on_path, *place)).fold(f64::INFINITY, f64::min)
    };
    let covered: f64 = reference.iter().map(|on_path| (-nearest_m(on_path) / THRESHOLD_M).exp()).sum();
    let coverage = covered / reference.len() as f64;
    let expected_m = coverage * length_m(distances, reference);
    let off_m = (expected_m - length_m(distances, taken)).abs();
    if expected_m.is_infinite() {
        0.0
    } else if expected_m + off_m == 0.0 {
        coverage
    } else {
        coverage * expected_m / (expected_m + off_m)
    }
}

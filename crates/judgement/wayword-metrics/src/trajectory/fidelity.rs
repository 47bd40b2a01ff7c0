//! How closely a trajectory follows the annotated path.

use super::{
    Distances,
    score::{ARRIVED_M, length_m},
};
use wayword_core::ViewpointId;

/// nDTW: `exp(-DTW / (3 m * nodes of the reference))`, with distances over the graph (Magalhaes et al. 2019, arXiv 1907.05446;
/// VLN-DUET, `map_nav_src/r2r/eval_utils.py`, `cal_dtw`). 0 where no way joins the two.
pub(super) fn normalised_warping(distances: &Distances, stood: &[ViewpointId], reference: &[ViewpointId]) -> f64 {
    let mut before = vec![f64::INFINITY; reference.len() + 1];
    before[0] = 0.0;
    for at in stood {
        let mut row = vec![f64::INFINITY; reference.len() + 1];
        for (place, node) in reference.iter().enumerate() {
            let apart_m = distances.metres(at, node).unwrap_or(f64::INFINITY);
            row[place + 1] = apart_m + before[place].min(before[place + 1]).min(row[place]);
        }
        before = row;
    }
    (-before[reference.len()] / (ARRIVED_M * reference.len() as f64)).exp()
}

/// CLS: path coverage times length score (Jain et al. 2019, arXiv 1905.12255; VLN-DUET, `map_nav_src/r2r/eval_utils.py`, `cal_cls`).
/// The reference divides zero by zero where both lengths are 0; there the length score is 1.
pub(super) fn coverage_weighted_by_length(
    distances: &Distances,
    stood: &[ViewpointId],
    reference: &[ViewpointId],
) -> f64 {
    let nearest_m =
        |node: &ViewpointId| stood.iter().filter_map(|at| distances.metres(at, node)).fold(f64::INFINITY, f64::min);
    let covered: f64 = reference.iter().map(|node| (-nearest_m(node) / ARRIVED_M).exp()).sum();
    let coverage = covered / reference.len() as f64;
    let expected_m = coverage * length_m(distances, reference);
    let off_m = (expected_m - length_m(distances, stood)).abs();
    let length_score = if expected_m + off_m > 0.0 { expected_m / (expected_m + off_m) } else { 1.0 };
    coverage * length_score
}

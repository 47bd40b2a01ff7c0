//! Computes how likely an instruction means each of several walks.

use crate::{fit::WalkFit, tree::WalkTree};

/// The share of each walk: the probability that the text means it, given that it means one of the tree. The start alone
/// is no walk.
#[must_use]
pub fn walk_shares(fit: &WalkFit, tree: &WalkTree) -> Vec<f64> {
    let scores: Vec<f64> =
        (0..tree.len()).map(|walk| if walk == 0 { f64::NEG_INFINITY } else { fit.score(walk) }).collect();
    let highest = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !highest.is_finite() {
        return vec![0.0; scores.len()];
    }
    let parts: Vec<f64> = scores.iter().map(|score| (score - highest).exp()).collect();
    let whole: f64 = parts.iter().sum();
    parts.iter().map(|part| part / whole).collect()
}

/// The walk that fits best; `None` where there is none.
#[must_use]
pub fn best_walk(fit: &WalkFit, tree: &WalkTree) -> Option<usize> {
    (1..tree.len()).filter(|walk| fit.score(*walk).is_finite()).max_by(|a, b| fit.score(*a).total_cmp(&fit.score(*b)))
}

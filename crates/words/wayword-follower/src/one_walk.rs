//! Scores variants of a text on one known walk, to compare them.

use crate::{
    building::Building,
    fit::Fit,
    guide::{Guide, Trial},
    tree::Tree,
    weights::Weights,
};

/// A known walk with everything that is needed to score texts on it.
pub(crate) struct OneWalk<'a> {
    building: &'a Building,
    tree: Tree,
    weights: &'a Weights,
}

impl<'a> OneWalk<'a> {
    /// `walk` lists the viewpoints of the walk, and `heading_rad` is the direction of the walker at its start (radians
    /// from +y, clockwise).
    pub(crate) fn new(building: &'a Building, walk: &[usize], heading_rad: f64, weights: &'a Weights) -> Self {
        Self { building, tree: Tree::single(building, walk, heading_rad), weights }
    }

    /// The score of a text on this walk; only differences between scores are meaningful.
    pub(crate) fn score(&self, guide: &Guide) -> f64 {
        Fit::new(&Trial::new(guide, self.building), &self.tree, self.weights).score(self.tree.len() - 1)
    }
}

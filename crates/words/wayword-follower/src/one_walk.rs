//! One walk alone, against which texts that differ a little are held.

use crate::{
    building::Building,
    fit::Fit,
    guide::{Guide, Trial},
    tree::Tree,
    weights::Weights,
};

/// A walk that is known.
pub(crate) struct OneWalk<'a> {
    building: &'a Building,
    tree: Tree,
    weights: &'a Weights,
}

impl<'a> OneWalk<'a> {
    /// `walk` has the viewpoints of the walk, and `heading_rad` says which way it begins (radians from +y, clockwise).
    pub(crate) fn new(building: &'a Building, walk: &[usize], heading_rad: f64, weights: &'a Weights) -> Self {
        Self { building, tree: Tree::single(building, walk, heading_rad), weights }
    }

    /// How well a text fits it: only differences mean anything.
    pub(crate) fn score(&self, guide: &Guide) -> f64 {
        Fit::new(&Trial::new(guide, self.building), &self.tree, self.weights).score(self.tree.len() - 1)
    }
}

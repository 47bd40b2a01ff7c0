//! Scores variants of a text on one known walk, to compare them.

use crate::{
    building::KnownBuilding,
    fit::WalkFit,
    guide::{Guide, GuideTrial},
    tree::WalkTree,
    weights::FeatureWeights,
};

/// A known walk with everything that is needed to score texts on it.
pub(crate) struct OneWalk<'a> {
    building: &'a KnownBuilding,
    tree: WalkTree,
    weights: &'a FeatureWeights,
}

impl<'a> OneWalk<'a> {
    /// `walk` lists the viewpoints of the walk, and `heading_rad` is the direction of the walker at its start (radians
    /// from +y, clockwise).
    pub(crate) fn new(
        building: &'a KnownBuilding,
        walk: &[usize],
        heading_rad: f64,
        weights: &'a FeatureWeights,
    ) -> Self {
        Self { building, tree: WalkTree::single_walk(building, walk, heading_rad), weights }
    }

    /// The score of a text on this walk; only differences between scores are meaningful.
    pub(crate) fn score(&self, guide: &Guide) -> f64 {
        // The tree is a chain; its last node is the end of the walk.
        WalkFit::new(&GuideTrial::new(guide, self.building), &self.tree, self.weights).score(self.tree.len() - 1)
    }
}

//! Scores how well an instruction fits walks: the sum over all ways to cut a walk into stretches, one for each step of
//! the text, of the weights of the steps' features. Dynamic programming over the tree computes it for all walks at
//! once.

use crate::{
    features::{MAX_STEP_HOPS, WalkStretch, ending_features, stretch_features},
    guide::GuideTrial,
    tree::WalkTree,
    weights::FeatureWeights,
};
use wayword_core::walk_cuts::log_sum;

/// Largest product of the number of a text's steps and the number of walks. Beyond it the text should not be followed, because the
/// tables would fill the memory.
pub const MAX_FOLLOW_WORK: usize = 2_000_000;

/// The scores of an instruction for all walks of a tree.
#[derive(Debug, Clone)]
pub struct WalkFit {
    /// For each number of steps, from none to all, and each node: the log of the sum over all ways in which these steps
    /// lead there.
    sums: Vec<Vec<f64>>,
    /// For each step, node and number of hops: the weight of the step over the stretch that ends there.
    stretches: Vec<f64>,
    /// For each node: the weight of the walk's end there.
    endings: Vec<f64>,
}

impl WalkFit {
    /// Fits an instruction to all walks of a tree.
    #[must_use]
    pub fn new(trial: &GuideTrial<'_>, tree: &WalkTree, weights: &FeatureWeights) -> Self {
        let mut starts = vec![f64::NEG_INFINITY; tree.len()];
        starts[0] = 0.0;
        if trial.guide.is_empty() {
            // A text without steps fits every walk: only the endings count.
            starts.fill(0.0);
        }
        Self::with_starts(trial, tree, weights, starts)
    }

    /// The same for an instruction whose first step may begin at any node.
    pub(crate) fn from_anywhere(trial: &GuideTrial<'_>, tree: &WalkTree, weights: &FeatureWeights) -> Self {
        Self::with_starts(trial, tree, weights, vec![0.0; tree.len()])
    }

    fn with_starts(trial: &GuideTrial<'_>, tree: &WalkTree, weights: &FeatureWeights, starts: Vec<f64>) -> Self {
        let (nodes, steps) = (tree.len(), trial.guide.len());
        let mut sums = vec![vec![f64::NEG_INFINITY; nodes]; steps + 1];
        sums[0] = starts;
        let mut stretches = vec![f64::NEG_INFINITY; steps * nodes * (MAX_STEP_HOPS + 1)];
        let mut found = Vec::new();
        for step in 0..steps {
            let (before, after) = sums.split_at_mut(step + 1);
            let (before, after) = (&before[step], &mut after[0]);
            for end in 0..nodes {
                let reached = tree
                    .nodes_back(end)
                    .take(MAX_STEP_HOPS + 1)
                    .enumerate()
                    .filter(|(_, from)| before[*from].is_finite());
                for (hops, from) in reached {
                    found.clear();
                    stretch_features(trial, step, &WalkStretch::to_node(tree, end, hops), &mut found);
                    let weight = weights.sum_weights(&found);
                    stretches[stretch_index(nodes, step, end, hops)] = weight;
                    after[end] = log_sum(after[end], before[from] + weight);
                }
            }
        }
        let endings = (0..nodes)
            .map(|end| {
                found.clear();
                ending_features(trial, tree, end, &mut found);
                weights.sum_weights(&found)
            })
            .collect();
        Self { sums, stretches, endings }
    }

    /// The score of the whole text for the walk that ends at a node: higher is better, and only differences are
    /// meaningful.
    #[must_use]
    pub fn score(&self, walk: usize) -> f64 {
        self.sums[self.sums.len() - 1][walk] + self.endings[walk]
    }

    /// The log of the sum over all ways in which the first `steps` steps lead to a node.
    pub(crate) fn sum_after(&self, steps: usize, node: usize) -> f64 {
        self.sums[steps][node]
    }

    /// The weight of a step over the stretch of `hops` hops that ends at a node of a tree with `nodes` nodes; minus infinity if no way
    /// to follow the text takes it.
    pub(crate) fn stretch_weight(&self, nodes: usize, step: usize, end: usize, hops: usize) -> f64 {
        if hops > MAX_STEP_HOPS { f64::NEG_INFINITY } else { self.stretches[stretch_index(nodes, step, end, hops)] }
    }

    /// Adds the gradient of the goal by each weight to `slope`. `by_score` is, for each node, the derivative of the
    /// goal by the node's score. `by_sums` has the derivatives by the sums after some of the steps; it may be empty.
    pub(crate) fn add_slope(
        &self,
        trial: &GuideTrial<'_>,
        tree: &WalkTree,
        by_score: &[f64],
        by_sums: &[Vec<f64>],
        slope: &mut [f64],
    ) {
        let nodes = tree.len();
        let mut found = Vec::new();
        let mut by_sum = by_score.to_vec();
        for (end, by_score) in by_score.iter().enumerate().filter(|(_, by_score)| by_score.abs() > NEGLIGIBLE_SHARE) {
            found.clear();
            ending_features(trial, tree, end, &mut found);
            found.iter().for_each(|feature| slope[*feature as usize] += by_score);
        }
        for step in (0..trial.guide.len()).rev() {
            let mut by_sum_before = vec![0.0; nodes];
            for (end, by_sum) in by_sum.iter().enumerate().filter(|(_, by_sum)| by_sum.abs() > NEGLIGIBLE_SHARE) {
                for (hops, from) in tree.nodes_back(end).take(MAX_STEP_HOPS + 1).enumerate() {
                    let weight = self.stretches[stretch_index(nodes, step, end, hops)];
                    if weight == f64::NEG_INFINITY {
                        continue;
                    }
                    let share = by_sum * (self.sums[step][from] + weight - self.sums[step + 1][end]).exp();
                    by_sum_before[from] += share;
                    if share.abs() > NEGLIGIBLE_SHARE {
                        found.clear();
                        stretch_features(trial, step, &WalkStretch::to_node(tree, end, hops), &mut found);
                        found.iter().for_each(|feature| slope[*feature as usize] += share);
                    }
                }
            }
            if let Some(more) = by_sums.get(step) {
                by_sum_before.iter_mut().zip(more).for_each(|(by, more)| *by += more);
            }
            by_sum = by_sum_before;
        }
    }
}

/// Shares below this are ignored.
pub(crate) const NEGLIGIBLE_SHARE: f64 = 1e-6;

/// The index in [`WalkFit::stretches`] of a step over the stretch of `hops` hops that ends at the node `end`.
fn stretch_index(nodes: usize, step: usize, end: usize, hops: usize) -> usize {
    (step * nodes + end) * (MAX_STEP_HOPS + 1) + hops
}

#[cfg(test)]
mod tests;

//! Scores going on to an unvisited viewpoint: how well the beginning of an instruction fits a walk to there, with the
//! last begun step still in progress.

use crate::{
    features::{FeatureNumber, MAX_STEP_HOPS, WalkStretch, stretch_features, tables},
    fit::WalkFit,
    guide::GuideTrial,
    learn::{AdamDescent, FitPlan, hold_strengths},
    tree::WalkTree,
    weights::FeatureWeights,
};
use std::sync::LazyLock;
use wayword_core::walk_cuts::log_sum;

/// The weights of a walker.
#[derive(Debug, Clone, PartialEq)]
pub struct OnwardWeights {
    /// The weights of completed steps, and of a walk's end.
    pub done: FeatureWeights,
    /// The weights of the step in progress.
    pub going: FeatureWeights,
    /// Weights of going on, by the number of steps after the one in progress.
    pub left: [f64; STEPS_LEFT_CLASSES],
    /// Weights of stopping at a viewpoint, and of going on to one, by how many hops away it is.
    pub away: [[f64; HOPS_AWAY_CLASSES]; 2],
}

/// Classes of the number of steps after the one in progress: 0 to 6, and more.
pub(crate) const STEPS_LEFT_CLASSES: usize = 8;
/// Classes of the number of hops to a viewpoint: 0 to 6, and more.
pub(crate) const HOPS_AWAY_CLASSES: usize = 8;

static FITTED_ONWARD_WEIGHTS: LazyLock<OnwardWeights> =
    LazyLock::new(|| OnwardWeights::parse(include_str!("fitted.json")).unwrap_or_else(|_| OnwardWeights::by_hand()));

impl OnwardWeights {
    /// The weights that the program uses: fitted to people's texts, as documented in their file.
    #[must_use]
    pub fn fitted() -> &'static Self {
        &FITTED_ONWARD_WEIGHTS
    }

    /// Weights written by hand.
    #[must_use]
    pub fn by_hand() -> Self {
        Self {
            done: FeatureWeights::by_hand(),
            going: FeatureWeights::by_hand(),
            left: [0.0; STEPS_LEFT_CLASSES],
            away: [[0.0; HOPS_AWAY_CLASSES]; 2],
        }
    }

    /// All weights in one list: of completed steps, of the step in progress, and the rest.
    pub(super) fn values(&self) -> Vec<f64> {
        [self.done.values(), self.going.values(), &self.left, self.away.as_flattened()].concat()
    }

    /// The weights from a list of that form.
    pub(super) fn from_values(values: &[f64]) -> Self {
        let part =
            |number: usize| FeatureWeights::from_values(&values[number * tables::COUNT..(number + 1) * tables::COUNT]);
        let rest = &values[2 * tables::COUNT..];
        let mut weights = Self {
            done: part(0),
            going: part(1),
            left: [0.0; STEPS_LEFT_CLASSES],
            away: [[0.0; HOPS_AWAY_CLASSES]; 2],
        };
        weights.left.copy_from_slice(&rest[..STEPS_LEFT_CLASSES]);
        weights.away.as_flattened_mut().copy_from_slice(&rest[STEPS_LEFT_CLASSES..]);
        weights
    }
}

/// A fit of a walker's weights.
#[derive(Debug)]
pub struct OnwardLearner {
    descent: AdamDescent,
}

impl OnwardLearner {
    /// Begins with weights.
    #[must_use]
    pub fn new(plan: FitPlan, start: &OnwardWeights) -> Self {
        let holds = [
            hold_strengths(plan, tables::ALL),
            hold_strengths(plan, tables::ALL),
            vec![plan.hold; STEPS_LEFT_CLASSES + 2 * HOPS_AWAY_CLASSES],
        ]
        .concat();
        Self { descent: AdamDescent::new(plan, start.values(), holds) }
    }

    /// The weights as they are.
    #[must_use]
    pub fn current_weights(&self) -> OnwardWeights {
        OnwardWeights::from_values(&self.descent.values)
    }

    /// Goes one step down a slope; `round` counts from 0.
    pub fn step_down(&mut self, round: usize, slope: &OnwardSlope) {
        self.descent.step_down(
            round,
            &[&slope.done[..], &slope.going, &slope.left, slope.away.as_flattened()].concat(),
            slope.decisions,
        );
    }

    /// The mean of the weights over the last round.
    #[must_use]
    pub fn finish(self) -> OnwardWeights {
        OnwardWeights::from_values(&self.descent.finish())
    }
}

/// How well the text fits going on to viewpoints that were not visited.
#[derive(Debug, Clone)]
pub struct OnwardFit {
    /// For each node: the log of the sum over all steps that may be in progress there, and their stretches.
    scores: Vec<f64>,
    /// For each node, the terms of its sum: step, hops, value.
    parts: Vec<Vec<(usize, usize, f64)>>,
}

impl OnwardFit {
    /// Scores going on to each node with an unvisited viewpoint.
    #[must_use]
    pub fn new(trial: &GuideTrial<'_>, tree: &WalkTree, fit: &WalkFit, weights: &OnwardWeights) -> Self {
        let steps = trial.guide.len();
        let mut found: Vec<FeatureNumber> = Vec::new();
        let mut parts = vec![Vec::new(); tree.len()];
        let is_new = |node: &usize| !trial.building.viewpoints[tree.end_viewpoint(*node)].is_known;
        for end in (1..tree.len()).filter(is_new) {
            for (hops, from) in tree.nodes_back(end).take(MAX_STEP_HOPS + 1).enumerate().skip(1) {
                for step in 0..steps {
                    let sum = fit.sum_after(step, from);
                    if !sum.is_finite() {
                        continue;
                    }
                    found.clear();
                    stretch_features(trial, step, &WalkStretch::to_node(tree, end, hops), &mut found);
                    let value = sum + weights.going.sum_weights(&found) + weights.left[steps_left_class(steps, step)];
                    parts[end].push((step, hops, value));
                }
            }
        }
        let score = |parts: &Vec<(usize, usize, f64)>| {
            parts.iter().fold(f64::NEG_INFINITY, |sum, (_, _, value)| log_sum(sum, *value))
        };
        Self { scores: parts.iter().map(score).collect(), parts }
    }

    /// How well the text fits going on to a node; only differences mean anything.
    #[must_use]
    pub fn score(&self, node: usize) -> f64 {
        self.scores[node]
    }
}

/// The class of the number of steps that come after a step.
fn steps_left_class(steps: usize, step: usize) -> usize {
    (steps - step - 1).min(STEPS_LEFT_CLASSES - 1)
}

/// The gradient of the loss over decisions.
#[derive(Debug, Clone)]
pub struct OnwardSlope {
    /// The gradient by the fields of [`OnwardWeights`] with the same names.
    pub(crate) done: Vec<f64>,
    pub(crate) going: Vec<f64>,
    pub(crate) left: [f64; STEPS_LEFT_CLASSES],
    pub(crate) away: [[f64; HOPS_AWAY_CLASSES]; 2],
    /// Sum of the losses.
    pub loss: f64,
    /// Number of decisions.
    pub decisions: usize,
}

impl Default for OnwardSlope {
    fn default() -> Self {
        let zeros = || vec![0.0; tables::COUNT];
        Self {
            done: zeros(),
            going: zeros(),
            left: [0.0; STEPS_LEFT_CLASSES],
            away: [[0.0; HOPS_AWAY_CLASSES]; 2],
            loss: 0.0,
            decisions: 0,
        }
    }
}

impl OnwardSlope {
    /// Adds a decision: the share of stopping at each node and of going on to each, less 1 for the right one.
    pub(crate) fn add_decision(
        &mut self,
        trial: &GuideTrial<'_>,
        tree: &WalkTree,
        (fit, onward): (&WalkFit, &OnwardFit),
        [by_stop, by_going]: [&[f64]; 2],
    ) {
        let steps = trial.guide.len();
        let mut by_sum = vec![vec![0.0; tree.len()]; steps];
        let mut found: Vec<FeatureNumber> = Vec::new();
        for (end, by) in by_going.iter().enumerate().filter(|(_, by)| **by != 0.0) {
            let froms: Vec<usize> = tree.nodes_back(end).take(MAX_STEP_HOPS + 1).collect();
            for (step, hops, value) in &onward.parts[end] {
                let share = by * (value - onward.scores[end]).exp();
                by_sum[*step][froms[*hops]] += share;
                self.left[steps_left_class(steps, *step)] += share;
                // Smaller shares are ignored, to save time.
                if share.abs() > 1e-6 {
                    found.clear();
                    stretch_features(trial, *step, &WalkStretch::to_node(tree, end, *hops), &mut found);
                    found.iter().for_each(|feature| self.going[*feature as usize] += share);
                }
            }
        }
        fit.add_slope(trial, tree, by_stop, &by_sum, &mut self.done);
        self.decisions += 1;
    }

    /// Adds another slope.
    #[must_use]
    pub fn plus(mut self, other: &Self) -> Self {
        let add = |a: &mut [f64], b: &[f64]| a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        add(&mut self.done, &other.done);
        add(&mut self.going, &other.going);
        add(&mut self.left, &other.left);
        add(self.away.as_flattened_mut(), other.away.as_flattened());
        self.loss += other.loss;
        self.decisions += other.decisions;
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_of_weights_can_be_read() {
        let weights = OnwardWeights::parse(include_str!("fitted.json"));
        assert!(weights.is_ok(), "{:?}", weights.err());
    }
}

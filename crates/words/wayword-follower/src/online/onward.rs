//! Scores going on to an unvisited viewpoint: how well the beginning of an instruction fits a walk to there, with the
//! last begun step still in progress.

use crate::{
    features::{Feature, MOST_HOPS, Stretch, stretch, tables},
    fit::{Fit, log_sum},
    guide::Trial,
    learn::{Descent, Plan, holds},
    tree::Tree,
    weights::Weights,
};
use std::sync::LazyLock;

/// The weights of a walker.
#[derive(Debug, Clone, PartialEq)]
pub struct OnwardWeights {
    /// The weights of completed steps, and of a walk's end.
    pub done: Weights,
    /// The weights of the step in progress.
    pub going: Weights,
    /// Weights of going on, by the number of steps after the one in progress.
    pub left: [f64; LEFT],
    /// Weights of stopping at a viewpoint, and of going on to one, by how many hops away it is.
    pub away: [[f64; AWAY]; 2],
}

/// Classes of the number of steps that are left.
pub(crate) const LEFT: usize = 8;
/// Classes of hops to an option.
pub(crate) const AWAY: usize = 8;

static FITTED: LazyLock<OnwardWeights> =
    LazyLock::new(|| OnwardWeights::parse(include_str!("fitted.json")).unwrap_or_else(|_| OnwardWeights::by_hand()));

impl OnwardWeights {
    /// The weights that the program uses: fitted to people's texts, as documented in their file.
    #[must_use]
    pub fn fitted() -> &'static Self {
        &FITTED
    }

    /// Weights written by hand.
    #[must_use]
    pub fn by_hand() -> Self {
        Self { done: Weights::by_hand(), going: Weights::by_hand(), left: [0.0; LEFT], away: [[0.0; AWAY]; 2] }
    }

    /// All weights in one list: of completed steps, of the step in progress, and the rest.
    pub(super) fn values(&self) -> Vec<f64> {
        [self.done.values(), self.going.values(), &self.left, self.away.as_flattened()].concat()
    }

    /// The weights from a list of that form.
    pub(super) fn from_values(values: &[f64]) -> Self {
        let part = |number: usize| Weights::from_values(&values[number * tables::COUNT..(number + 1) * tables::COUNT]);
        let rest = &values[2 * tables::COUNT..];
        let mut weights = Self { done: part(0), going: part(1), left: [0.0; LEFT], away: [[0.0; AWAY]; 2] };
        weights.left.copy_from_slice(&rest[..LEFT]);
        weights.away.as_flattened_mut().copy_from_slice(&rest[LEFT..]);
        weights
    }
}

/// A fit of a walker's weights.
#[derive(Debug)]
pub struct OnwardLearner {
    descent: Descent,
}

impl OnwardLearner {
    /// Begins with weights.
    #[must_use]
    pub fn new(plan: Plan, start: &OnwardWeights) -> Self {
        let holds = [holds(plan), holds(plan), vec![plan.hold; LEFT + 2 * AWAY]].concat();
        Self { descent: Descent::new(plan, start.values(), holds) }
    }

    /// The weights as they are.
    #[must_use]
    pub fn weights(&self) -> OnwardWeights {
        OnwardWeights::from_values(&self.descent.values)
    }

    /// Goes one step down a slope; `round` counts from 0.
    pub fn step(&mut self, round: usize, slope: &OnwardSlope) {
        self.descent.step(
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
pub struct Onward {
    /// For each node: the log of the sum over steps and stretches.
    scores: Vec<f64>,
    /// For each node, the terms of its sum: step, hops, value.
    parts: Vec<Vec<(usize, usize, f64)>>,
}

impl Onward {
    /// Scores going on to each node with an unvisited viewpoint.
    #[must_use]
    pub fn new(trial: &Trial<'_>, tree: &Tree, fit: &Fit, weights: &OnwardWeights) -> Self {
        let steps = trial.guide.len();
        let mut found: Vec<Feature> = Vec::new();
        let mut parts = vec![Vec::new(); tree.len()];
        let is_new = |node: &usize| !trial.building.viewpoints[tree.end(*node)].is_known;
        for end in (1..tree.len()).filter(is_new) {
            for (hops, from) in tree.back(end).take(MOST_HOPS + 1).enumerate().skip(1) {
                for step in 0..steps {
                    let sum = fit.sum(step, from);
                    if !sum.is_finite() {
                        continue;
                    }
                    found.clear();
                    stretch(trial, step, &Stretch::to(tree, end, hops), &mut found);
                    let value = sum + weights.going.of(&found) + weights.left[left(steps, step)];
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

fn left(steps: usize, step: usize) -> usize {
    (steps - step - 1).min(LEFT - 1)
}

/// The gradient of the loss over decisions.
#[derive(Debug, Clone)]
pub struct OnwardSlope {
    pub(crate) done: Vec<f64>,
    pub(crate) going: Vec<f64>,
    pub(crate) left: [f64; LEFT],
    pub(crate) away: [[f64; AWAY]; 2],
    /// Sum of the losses.
    pub loss: f64,
    /// Number of decisions.
    pub decisions: usize,
}

impl Default for OnwardSlope {
    fn default() -> Self {
        let zeros = || vec![0.0; tables::COUNT];
        Self { done: zeros(), going: zeros(), left: [0.0; LEFT], away: [[0.0; AWAY]; 2], loss: 0.0, decisions: 0 }
    }
}

impl OnwardSlope {
    /// Adds a decision: the share of stopping at each node and of going on to each, less 1 for the right one.
    pub(crate) fn add(
        &mut self,
        trial: &Trial<'_>,
        tree: &Tree,
        (fit, onward): (&Fit, &Onward),
        [by_stop, by_going]: [&[f64]; 2],
    ) {
        let steps = trial.guide.len();
        let mut by_sum = vec![vec![0.0; tree.len()]; steps];
        let mut found: Vec<Feature> = Vec::new();
        for (end, by) in by_going.iter().enumerate().filter(|(_, by)| **by != 0.0) {
            let froms: Vec<usize> = tree.back(end).take(MOST_HOPS + 1).collect();
            for (step, hops, value) in &onward.parts[end] {
                let share = by * (value - onward.scores[end]).exp();
                by_sum[*step][froms[*hops]] += share;
                self.left[left(steps, *step)] += share;
                if share.abs() > 1e-6 {
                    found.clear();
                    stretch(trial, *step, &Stretch::to(tree, end, *hops), &mut found);
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

//! Fits the weights of the features to texts of known walks, by gradient descent on the likelihood.
//!
//! The likelihood of a walk is its share among all walks of a tree: a softmax of their scores. Adam follows the
//! gradient; the result is the mean of the weights over the last round.

use crate::{
    features::tables::{self, FeatureTable},
    fit::WalkFit,
    guide::GuideTrial,
    posterior::walk_shares,
    tree::WalkTree,
    weights::FeatureWeights,
};

/// The settings of a fit.
#[derive(Debug, Clone, Copy)]
pub struct FitPlan {
    /// Rounds over all texts.
    pub rounds: usize,
    /// Number of texts for each step of the descent.
    pub batch: usize,
    /// Length of the first step; the steps get shorter up to the end.
    pub rate: f64,
    /// Strength of the pull of the weights towards their start values.
    pub hold: f64,
    /// Factor of this strength for the weights of fine tables.
    pub hold_fine: f64,
}

impl Default for FitPlan {
    fn default() -> Self {
        Self { rounds: 10, batch: 64, rate: 0.05, hold: 3e-4, hold_fine: 5.0 }
    }
}

/// The gradient of the loss over texts, and the loss.
#[derive(Debug, Clone)]
pub struct FitSlope {
    /// The gradient, one value for each weight.
    values: Vec<f64>,
    /// Sum of the losses of all texts: the negative log of the known walk's share.
    pub loss: f64,
    /// Number of texts.
    texts: usize,
}

impl Default for FitSlope {
    fn default() -> Self {
        Self { values: vec![0.0; tables::COUNT], loss: 0.0, texts: 0 }
    }
}

impl FitSlope {
    /// Adds a text. `goal` is the known walk's number in the tree. The start alone is no walk, so it cannot be the
    /// goal.
    pub fn add_text(&mut self, trial: &GuideTrial<'_>, tree: &WalkTree, goal: usize, weights: &FeatureWeights) {
        let fit = WalkFit::new(trial, tree, weights);
        let shares = walk_shares(&fit, tree);
        if !shares[goal].is_normal() {
            return;
        }
        let by_score: Vec<f64> =
            shares.iter().enumerate().map(|(walk, share)| share - f64::from(u8::from(walk == goal))).collect();
        fit.add_slope(trial, tree, &by_score, &[], &mut self.values);
        self.loss -= shares[goal].ln();
        self.texts += 1;
    }

    /// Adds an empty text (`nothing`) for a walk, which teaches the follower a default for texts without information. It does not
    /// count in the number of texts.
    pub fn add_empty_text(&mut self, nothing: &GuideTrial<'_>, tree: &WalkTree, goal: usize, weights: &FeatureWeights) {
        let mut empty_text = Self::default();
        empty_text.add_text(nothing, tree, goal, weights);
        self.values.iter_mut().zip(&empty_text.values).for_each(|(a, b)| *a += b);
    }

    /// Adds a pair of texts for a walk: the right one, and one that a single change made wrong. The right one should
    /// score higher. `walk` is a tree of that walk alone. `strength` is the weight of the pair; a text has weight 1.
    pub fn add_contrast(
        &mut self,
        right: &GuideTrial<'_>,
        wrong: &GuideTrial<'_>,
        walk: &WalkTree,
        weights: &FeatureWeights,
        strength: f64,
    ) {
        let fits = [right, wrong].map(|trial| WalkFit::new(trial, walk, weights));
        let end = walk.len() - 1;
        let gain = fits[1].score(end) - fits[0].score(end);
        if !gain.is_finite() {
            return;
        }
        // The share of the wrong text among the two.
        let share = strength / (1.0 + (-gain).exp());
        let mut by_score = vec![0.0; walk.len()];
        for ((fit, trial), by) in fits.iter().zip([right, wrong]).zip([-share, share]) {
            by_score[end] = by;
            fit.add_slope(trial, walk, &by_score, &[], &mut self.values);
        }
    }

    /// Adds another gradient.
    #[must_use]
    pub fn plus(mut self, other: &Self) -> Self {
        self.values.iter_mut().zip(&other.values).for_each(|(a, b)| *a += b);
        self.loss += other.loss;
        self.texts += other.texts;
        self
    }
}

/// A running fit.
#[derive(Debug)]
pub struct WeightLearner {
    descent: AdamDescent,
}

impl WeightLearner {
    /// Begins with weights.
    #[must_use]
    pub fn new(plan: FitPlan, start: &FeatureWeights) -> Self {
        Self { descent: AdamDescent::new(plan, start.values().to_vec(), hold_strengths(plan, tables::ALL)) }
    }

    /// The weights as they are.
    #[must_use]
    pub fn current_weights(&self) -> FeatureWeights {
        FeatureWeights::from_values(&self.descent.values)
    }

    /// Goes one step down the gradient; `round` counts from 0.
    pub fn step_down(&mut self, round: usize, slope: &FitSlope) {
        self.descent.step_down(round, &slope.values, slope.texts);
    }

    /// The mean of the weights over the last round.
    #[must_use]
    pub fn finish(self) -> FeatureWeights {
        FeatureWeights::from_values(&self.descent.finish())
    }
}

/// For each weight of the tables, the strength of the pull towards its start value.
pub(crate) fn hold_strengths(plan: FitPlan, tables: &[FeatureTable]) -> Vec<f64> {
    let strength = |table: &FeatureTable| if table.is_fine { plan.hold * plan.hold_fine } else { plan.hold };
    tables.iter().flat_map(|table| std::iter::repeat_n(strength(table), table.size)).collect()
}

/// The Adam optimiser with its state.
#[derive(Debug)]
pub(crate) struct AdamDescent {
    plan: FitPlan,
    /// The values at the start, towards which `holds` pull.
    start: Vec<f64>,
    /// The values as they are.
    pub(crate) values: Vec<f64>,
    holds: Vec<f64>,
    /// Running means of the gradient and of its square.
    mean: Vec<f64>,
    square: Vec<f64>,
    /// Number of steps so far.
    steps: i32,
    /// Sum of the values over the steps of the last round, and their number.
    sum: Vec<f64>,
    summed: usize,
}

impl AdamDescent {
    pub(crate) fn new(plan: FitPlan, start: Vec<f64>, holds: Vec<f64>) -> Self {
        let zeros = || vec![0.0; start.len()];
        let (mean, square, sum, values) = (zeros(), zeros(), zeros(), start.clone());
        Self { plan, start, values, holds, mean, square, steps: 0, sum, summed: 0 }
    }

    /// Goes one step down; `slope` is the sum of the gradients of `examples` examples.
    pub(crate) fn step_down(&mut self, round: usize, slope: &[f64], examples: usize) {
        /// Adam's usual decay rates.
        const ADAM_DECAY: [f64; 2] = [0.9, 0.999];
        // The steps get shorter from round to round.
        let remaining = 1.0 - round as f64 / self.plan.rounds.max(1) as f64;
        self.steps += 1;
        let [bias, bias_square] = ADAM_DECAY.map(|past| 1.0 - past.powi(self.steps));
        let is_last = round + 1 == self.plan.rounds;
        for (at, value) in self.values.iter_mut().enumerate() {
            let down = slope[at] / examples.max(1) as f64 + self.holds[at] * (*value - self.start[at]);
            self.mean[at] = ADAM_DECAY[0] * self.mean[at] + (1.0 - ADAM_DECAY[0]) * down;
            self.square[at] = ADAM_DECAY[1] * self.square[at] + (1.0 - ADAM_DECAY[1]) * down * down;
            *value -=
                self.plan.rate * remaining * (self.mean[at] / bias) / ((self.square[at] / bias_square).sqrt() + 1e-6);
            self.sum[at] += if is_last { *value } else { 0.0 };
        }
        self.summed += usize::from(is_last);
    }

    /// The mean of the values over the last round.
    pub(crate) fn finish(self) -> Vec<f64> {
        match self.summed {
            0 => self.values,
            count => self.sum.iter().map(|sum| sum / count as f64).collect(),
        }
    }
}

#[cfg(test)]
mod tests;

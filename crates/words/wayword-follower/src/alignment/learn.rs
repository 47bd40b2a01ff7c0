//! Fits the weights of the alignment to known stretches, by gradient descent on the likelihood of people's cut among all cuts.

use super::{AlignmentCase, AlignmentWeights, PartReading, features::ValuedFeature, tables};
use crate::{
    fit::NEGLIGIBLE_SHARE,
    learn::{AdamDescent, FitPlan, hold_strengths},
};
use wayword_core::walk_cuts::all_stretches;

/// The gradient of the loss over texts, and the loss.
#[derive(Debug, Clone)]
pub struct AlignmentSlope {
    values: Vec<f64>,
    /// Sum of the losses of all texts: the negative log of the share of the known cut.
    pub loss: f64,
    texts: usize,
}

impl Default for AlignmentSlope {
    fn default() -> Self {
        Self { values: vec![0.0; tables::COUNT], loss: 0.0, texts: 0 }
    }
}

impl AlignmentSlope {
    /// Adds a text with its known stretches, one for each part: consecutive, from the first to the last viewpoint of the walk.
    pub fn add_text(&mut self, case: &AlignmentCase<'_>, stretches: &[[usize; 2]], weights: &AlignmentWeights) {
        let cuts = case.walk_cuts(weights);
        let mut found: Vec<ValuedFeature> = Vec::new();
        let mut known_score = 0.0;
        for (part, known) in stretches.iter().enumerate() {
            let known = known.map(|at| case.place_near(at));
            for stretch in all_stretches(case.places()) {
                let is_known = stretch == known;
                let share = cuts.stretch_share(part, stretch);
                if share < NEGLIGIBLE_SHARE && !is_known {
                    continue;
                }
                found.clear();
                case.part_features(part, stretch, weights.reading, &mut found);
                if is_known {
                    known_score += weights.sum_weights(&found);
                }
                let by = share - f64::from(u8::from(is_known));
                found.iter().for_each(|(feature, value)| self.values[*feature as usize] += by * value);
            }
        }
        self.loss += cuts.total() - known_score;
        self.texts += 1;
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
pub struct AlignmentLearner {
    reading: PartReading,
    descent: AdamDescent,
}

impl AlignmentLearner {
    /// Begins with weights of 0.
    #[must_use]
    pub fn new(plan: FitPlan, reading: PartReading) -> Self {
        let holds = hold_strengths(plan, tables::ALL);
        Self { reading, descent: AdamDescent::new(plan, vec![0.0; tables::COUNT], holds) }
    }

    /// The weights as they are.
    #[must_use]
    pub fn current_weights(&self) -> AlignmentWeights {
        AlignmentWeights { reading: self.reading, values: self.descent.values.clone() }
    }

    /// Goes one step down the gradient; `round` counts from 0.
    pub fn step_down(&mut self, round: usize, slope: &AlignmentSlope) {
        self.descent.step_down(round, &slope.values, slope.texts);
    }

    /// The mean of the weights over the last round.
    #[must_use]
    pub fn finish(self) -> AlignmentWeights {
        AlignmentWeights { reading: self.reading, values: self.descent.finish() }
    }
}

#[cfg(test)]
mod tests;

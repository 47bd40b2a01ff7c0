//! The figures of a study that are simulated: their true values, and the intervals that one simulated study gives.

use super::assignment::{EffectSize, SimulatedDesign, assign_slots};
use super::{CONFIDENCE_LEVEL, choices, ratings, walks};
use rand::Rng;
use serde::Serialize;
use std::fmt;
use wayword_metrics::{ConfidenceInterval, answer_mean, answer_share, mean_difference, share_difference};

/// A figure of a study. Shares and means have a base: the share of success in the first condition.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum SimulatedFigure {
    /// A share.
    Share(f64),
    /// The difference between two shares.
    ShareDifference(f64),
    /// A mean of values like SPL: 0 without success, else up to 1.
    Mean(f64),
    /// The difference between two means of this kind.
    MeanDifference(f64),
    /// Agreement on five levels.
    Alpha,
    /// The strengths of three systems.
    Strengths,
}

impl SimulatedFigure {
    pub(super) const ALL: [Self; 10] = [
        Self::Share(0.5),
        Self::Share(0.8),
        Self::ShareDifference(0.5),
        Self::ShareDifference(0.8),
        Self::Mean(0.5),
        Self::Mean(0.8),
        Self::MeanDifference(0.5),
        Self::MeanDifference(0.8),
        Self::Alpha,
        Self::Strengths,
    ];

    /// The true values that the intervals should cover: one, or three for three systems.
    pub(super) fn true_values(self, effects: EffectSize) -> Vec<f64> {
        let sd = effects.sd_logits();
        let between = |[first, second]: [f64; 2]| first - second;
        match self {
            Self::Share(base) => vec![base],
            Self::ShareDifference(base) => vec![between(walks::true_shares(base, sd))],
            Self::Mean(base) => vec![walks::true_means(base, sd)[0]],
            Self::MeanDifference(base) => vec![between(walks::true_means(base, sd))],
            Self::Alpha => vec![ratings::true_alpha(sd)],
            Self::Strengths => choices::true_strengths(sd),
        }
    }

    /// The intervals that one simulated study gives, in the order of the truth; none where it gives none.
    pub(super) fn simulate_intervals(
        self,
        design: SimulatedDesign,
        effects: EffectSize,
        rng: &mut impl Rng,
    ) -> Vec<ConfidenceInterval> {
        let (slots, sd) = (assign_slots(design, rng), effects.sd_logits());
        let draw = |slots: &[_], base, rng: &mut _| walks::draw_walks(slots, base, sd, rng);
        let interval = match self {
            Self::Share(base) => {
                answer_share(&draw(&walks::with_first_condition(&slots), base, rng).successes[0], CONFIDENCE_LEVEL)
                    .and_then(|estimate| estimate.interval)
            }
            Self::Mean(base) => {
                answer_mean(&draw(&walks::with_first_condition(&slots), base, rng).values[0], CONFIDENCE_LEVEL)
                    .and_then(|estimate| estimate.interval)
            }
            Self::ShareDifference(base) => {
                let [first, second] = draw(&slots, base, rng).successes;
                share_difference(&first, &second, CONFIDENCE_LEVEL).and_then(|estimate| estimate.interval)
            }
            Self::MeanDifference(base) => {
                let [first, second] = draw(&slots, base, rng).values;
                mean_difference(&first, &second, CONFIDENCE_LEVEL).and_then(|estimate| estimate.interval)
            }
            Self::Alpha => ratings::alpha_interval(&slots, sd, rng),
            Self::Strengths => return choices::strength_intervals(&slots, sd, rng),
        };
        interval.into_iter().collect()
    }
}

impl fmt::Display for SimulatedFigure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Share(base) => write!(f, "share, {base}"),
            Self::ShareDifference(base) => write!(f, "difference of shares, {base}"),
            Self::Mean(base) => write!(f, "mean, {base}"),
            Self::MeanDifference(base) => write!(f, "difference of means, {base}"),
            Self::Alpha => write!(f, "Krippendorff's alpha"),
            Self::Strengths => write!(f, "Bradley-Terry strengths"),
        }
    }
}

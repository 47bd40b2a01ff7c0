//! Shares and means of answers by persons to items, and differences between two conditions.
//!
//! Answers of one person, or to one item, give no interval. If each person and each item occurs once, answers are independent. Otherwise
//! the variance is clustered both ways
//! (`variance.rs`). Shares get their interval on the logit scale by the delta method, so that it stays within 0 and 1.

mod difference;
mod variance;

use super::{ConfidenceInterval, StudyAnswer, is_level, logit_normal, quantile, wilson::wilson_interval};
pub use difference::{FigureDifference, mean_difference, share_difference};
use serde::{Deserialize, Serialize};
use std::fmt;
pub(super) use variance::{AnswerGroups, VarianceParts};

/// How an interval was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum IntervalMethod {
    /// Wilson's interval of a share of independent answers.
    Wilson,
    /// Student's interval of a mean of independent answers.
    Student,
    /// The variance is clustered by persons and by items.
    Clustered,
    /// For a share of 0 or 1 of dependent answers: Wilson's interval of as many answers as there are persons or items, whichever
    /// are fewer.
    Extreme,
    /// Newcombe's interval of the difference between two shares of independent answers.
    Newcombe,
    /// There is no interval, because the data do not show how precise the figure is: one person, one item, or no spread.
    None,
}

impl fmt::Display for IntervalMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Wilson => "Wilson",
            Self::Student => "Student's t",
            Self::Clustered => "clustered by persons and items",
            Self::Extreme => "Wilson with as many answers as persons or items",
            Self::Newcombe => "Newcombe",
            Self::None => "no interval",
        })
    }
}

/// A share or a mean with its interval.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StudyFigure {
    /// The share or the mean.
    pub value: f64,
    /// Its interval, where one can be made.
    pub interval: Option<ConfidenceInterval>,
    /// Its standard error, where it is above 0 and there are several persons and items.
    pub se: Option<f64>,
    /// How the interval was made.
    pub method: IntervalMethod,
    /// How many answers.
    pub answers: usize,
    /// How many persons gave them.
    pub persons: usize,
    /// How many items they are about.
    pub items: usize,
}

/// The share of answers that are 1, with its interval.
///
/// Values between 0 and 1 are taken too. `None` where there are no answers, a value is outside 0 to 1, or the level is not
/// between 0 and 1.
#[must_use]
pub fn answer_share<P: Ord, I: Ord>(answers: &[StudyAnswer<P, I>], level: f64) -> Option<StudyFigure> {
    let is_share = answers.iter().all(|answer| (0.0..=1.0).contains(&answer.value));
    let sample = is_share.then(|| AnswerSample::from_answers(answers, level)).flatten()?;
    Some(sample.share_figure(level))
}

/// The mean of answers, with its interval.
///
/// `None` where there are no answers, a value is not finite, or the level is not between 0 and 1.
#[must_use]
pub fn answer_mean<P: Ord, I: Ord>(answers: &[StudyAnswer<P, I>], level: f64) -> Option<StudyFigure> {
    Some(AnswerSample::from_answers(answers, level)?.mean_figure(level))
}

/// Answers to one condition.
struct AnswerSample {
    mean: f64,
    answers: usize,
    parts: VarianceParts,
}

impl AnswerSample {
    fn from_answers<P: Ord, I: Ord>(answers: &[StudyAnswer<P, I>], level: f64) -> Option<Self> {
        let is_finite = answers.iter().all(|answer| answer.value.is_finite());
        let mean = is_finite.then(|| average_value(answers)).flatten()?;
        let groups = AnswerGroups::from_pairs(answers.iter().map(|answer| (&answer.person, &answer.item)));
        let parts = groups.variance_parts(&error_contributions(answers, mean), 1);
        is_level(level).then_some(Self { mean, answers: answers.len(), parts })
    }

    /// The mean as a share, with the interval that suits the sample.
    fn share_figure(&self, level: f64) -> StudyFigure {
        let is_extreme = self.mean == 0.0 || self.mean == 1.0;
        let (method, interval) = if !self.parts.is_sample() {
            (IntervalMethod::None, None)
        } else if self.parts.is_independent() {
            (IntervalMethod::Wilson, wilson_interval(self.mean * self.answers as f64, self.answers as f64, level))
        } else if is_extreme {
            let fewest = self.parts.fewest_groups() as f64;
            (IntervalMethod::Extreme, wilson_interval(self.mean * fewest, fewest, level))
        } else {
            (IntervalMethod::Clustered, self.logit_interval(level))
        };
        self.to_figure(method, interval)
    }

    /// The interval on the logit scale, by the delta method: the derivative of the logit is 1 / (p (1 - p)).
    fn logit_interval(&self, level: f64) -> Option<ConfidenceInterval> {
        let half = self.half_width(level)? / (self.mean * (1.0 - self.mean));
        let centre = logit_normal::logit(self.mean);
        Some(ConfidenceInterval { low: logit_normal::expit(centre - half), high: logit_normal::expit(centre + half) })
    }

    /// The mean as a number, with Student's interval.
    fn mean_figure(&self, level: f64) -> StudyFigure {
        let method = if self.parts.is_independent() { IntervalMethod::Student } else { IntervalMethod::Clustered };
        self.to_figure(method, self.half_width(level).map(|half| symmetric_interval(self.mean, half)))
    }

    /// Half the width of the interval on the scale of the values.
    fn half_width(&self, level: f64) -> Option<f64> {
        Some(self.standard_error()? * quantile::student_quantile(0.5 + level / 2.0, self.parts.fewest_groups() - 1)?)
    }

    fn standard_error(&self) -> Option<f64> {
        Some(self.parts.variance().sqrt()).filter(|se| *se > 0.0 && self.parts.is_sample())
    }

    fn to_figure(&self, method: IntervalMethod, interval: Option<ConfidenceInterval>) -> StudyFigure {
        StudyFigure {
            value: self.mean,
            interval,
            se: self.standard_error(),
            method: if interval.is_some() { method } else { IntervalMethod::None },
            answers: self.answers,
            persons: self.parts.persons,
            items: self.parts.items,
        }
    }
}

/// The mean of answers. It is summed as differences from the first answer, so that it is exact if all answers are equal.
fn average_value<P, I>(answers: &[StudyAnswer<P, I>]) -> Option<f64> {
    let first = answers.first()?.value;
    let above: f64 = answers.iter().map(|answer| answer.value - first).sum();
    Some(first + above / answers.len() as f64)
}

/// The contribution of each answer to the error of the mean.
fn error_contributions<P, I>(answers: &[StudyAnswer<P, I>], mean: f64) -> Vec<f64> {
    answers.iter().map(|answer| (answer.value - mean) / answers.len() as f64).collect()
}

fn symmetric_interval(value: f64, half: f64) -> ConfidenceInterval {
    ConfidenceInterval { low: value - half, high: value + half }
}

#[cfg(test)]
mod tests;

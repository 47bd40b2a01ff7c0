//! The figures of a submission: those of each trajectory, and their means with intervals.

use serde::Serialize;
use std::sync::Arc;
use wayword_metrics::{Estimate, Metric, Rule, Score, clustered_interval};

/// Confidence level of the intervals.
pub const LEVEL: f64 = 0.95;

/// An instruction that a trajectory can be scored for.
#[derive(Debug)]
pub(super) struct Instruction {
    /// Its name in submissions.
    pub(super) name: String,
    /// The index of its item among the episodes.
    pub(super) item: usize,
    pub(super) item_id: String,
    /// The scene and path of the item, by which intervals are clustered.
    pub(super) path: String,
}

/// The figures of one trajectory.
#[derive(Debug)]
pub struct Scored {
    pub(super) instruction: usize,
    /// Whether an object was named.
    pub names_object: bool,
    /// The figures.
    pub score: Score,
}

/// The figures of a submission, in the order of the episodes.
#[derive(Debug)]
pub struct Scores {
    pub(super) instructions: Arc<[Instruction]>,
    pub(super) rows: Vec<Scored>,
}

/// One trajectory's line in a file of figures.
#[derive(Debug, Serialize)]
pub struct Line<'a> {
    instr_id: &'a str,
    item: &'a str,
    path: &'a str,
    #[serde(flatten)]
    score: &'a Score,
}

impl Scores {
    /// The trajectories.
    #[must_use]
    pub fn rows(&self) -> &[Scored] {
        &self.rows
    }

    /// The names of the instructions, in the order of the trajectories.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.known().map(|(known, _)| known.name.as_str())
    }

    /// The ids of the items, in the order of the trajectories.
    pub fn items(&self) -> impl Iterator<Item = &str> {
        self.known().map(|(known, _)| known.item_id.as_str())
    }

    /// The scene and path of each trajectory's item.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        self.known().map(|(known, _)| known.path.as_str())
    }

    /// The lines of a file of figures.
    pub fn lines(&self) -> impl Iterator<Item = Line<'_>> {
        self.known().map(|(known, row)| Line {
            instr_id: &known.name,
            item: &known.item_id,
            path: &known.path,
            score: &row.score,
        })
    }

    /// The value of a metric for each trajectory; `None` if the metric does not apply to it.
    pub fn values(&self, metric: Metric, rule: Rule) -> impl Iterator<Item = Option<f64>> {
        self.rows.iter().map(move |row| row.score.get(metric, rule))
    }

    /// The mean of a figure over the trajectories that have it; `None` if none has.
    #[must_use]
    pub fn mean(&self, metric: Metric, rule: Rule) -> Option<f64> {
        let (sum, number) =
            self.values(metric, rule).flatten().fold((0.0, 0u32), |(sum, n), value| (sum + value, n + 1));
        (number > 0).then(|| sum / f64::from(number))
    }

    /// The mean with its interval, clustered by path.
    #[must_use]
    pub fn estimate(&self, metric: Metric, rule: Rule, resamples: usize, seed: u64) -> Option<Estimate> {
        let values: Vec<(&str, f64)> =
            self.paths().zip(self.values(metric, rule)).filter_map(|(path, value)| Some((path, value?))).collect();
        clustered_interval(&values, resamples, LEVEL, seed)
    }

    /// Whether the rule can be applied to any of the trajectories.
    #[must_use]
    pub fn has(&self, rule: Rule) -> bool {
        self.values(Metric::SuccessRate, rule).any(|value| value.is_some())
    }

    /// Gives all scores to one instruction on one path, for tests.
    #[cfg(test)]
    pub(crate) fn of_one_path(scores: Vec<Score>) -> Self {
        let known = Instruction { name: "1_0".into(), item: 0, item_id: "1".into(), path: "a/1".into() };
        let rows = scores.into_iter().map(|score| Scored { instruction: 0, names_object: false, score }).collect();
        Self { instructions: [known].into(), rows }
    }

    fn known(&self) -> impl Iterator<Item = (&Instruction, &Scored)> {
        self.rows.iter().map(|row| (&self.instructions[row.instruction], row))
    }
}

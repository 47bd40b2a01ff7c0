//! The figures of a submission: those of each trajectory, and their means with intervals.

use serde::Serialize;
use std::sync::Arc;
use wayword_metrics::{MeanEstimate, TrajectoryMetric, TrajectoryScore, TrajectorySuccessRule, clustered_interval};

/// Confidence level of the intervals.
pub const CONFIDENCE_LEVEL: f64 = 0.95;

/// An instruction that a trajectory can be scored for.
#[derive(Debug)]
pub(super) struct JudgedInstruction {
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
pub struct ScoredTrajectory {
    /// The index of its instruction in the list of [`SubmissionScores`].
    pub(super) instruction: usize,
    /// Whether the trajectory names an object as the target.
    pub names_object: bool,
    /// The figures.
    pub score: TrajectoryScore,
}

/// The figures of a submission, in the order of the episodes.
#[derive(Debug)]
pub struct SubmissionScores {
    pub(super) instructions: Arc<[JudgedInstruction]>,
    pub(super) rows: Vec<ScoredTrajectory>,
}

/// One trajectory's line in a file of figures.
#[derive(Debug, Serialize)]
pub struct TrajectoryScoreRecord<'a> {
    instr_id: &'a str,
    item: &'a str,
    path: &'a str,
    #[serde(flatten)]
    score: &'a TrajectoryScore,
}

impl SubmissionScores {
    /// The trajectories.
    #[must_use]
    pub fn rows(&self) -> &[ScoredTrajectory] {
        &self.rows
    }

    /// The names of the instructions, in the order of the trajectories.
    pub fn instruction_names(&self) -> impl Iterator<Item = &str> {
        self.rows_with_instructions().map(|(known, _)| known.name.as_str())
    }

    /// The ids of the items, in the order of the trajectories.
    pub fn item_ids(&self) -> impl Iterator<Item = &str> {
        self.rows_with_instructions().map(|(known, _)| known.item_id.as_str())
    }

    /// The scene and path of each trajectory's item.
    pub fn path_names(&self) -> impl Iterator<Item = &str> {
        self.rows_with_instructions().map(|(known, _)| known.path.as_str())
    }

    /// The lines of a file of figures.
    pub fn score_records(&self) -> impl Iterator<Item = TrajectoryScoreRecord<'_>> {
        self.rows_with_instructions().map(|(known, row)| TrajectoryScoreRecord {
            instr_id: &known.name,
            item: &known.item_id,
            path: &known.path,
            score: &row.score,
        })
    }

    /// The value of a metric for each trajectory; `None` if the metric does not apply to it.
    pub fn metric_values(
        &self,
        metric: TrajectoryMetric,
        rule: TrajectorySuccessRule,
    ) -> impl Iterator<Item = Option<f64>> {
        self.rows.iter().map(move |row| row.score.get(metric, rule))
    }

    /// The mean of a figure over the trajectories that have it; `None` if none has.
    #[must_use]
    pub fn metric_mean(&self, metric: TrajectoryMetric, rule: TrajectorySuccessRule) -> Option<f64> {
        let (sum, number) =
            self.metric_values(metric, rule).flatten().fold((0.0, 0u32), |(sum, n), value| (sum + value, n + 1));
        (number > 0).then(|| sum / f64::from(number))
    }

    /// The mean with its interval, clustered by path.
    #[must_use]
    pub fn metric_estimate(
        &self,
        metric: TrajectoryMetric,
        rule: TrajectorySuccessRule,
        resamples: usize,
        seed: u64,
    ) -> Option<MeanEstimate> {
        let values: Vec<(&str, f64)> = self
            .path_names()
            .zip(self.metric_values(metric, rule))
            .filter_map(|(path, value)| Some((path, value?)))
            .collect();
        clustered_interval(&values, resamples, CONFIDENCE_LEVEL, seed)
    }

    /// Whether the rule can be applied to any of the trajectories.
    #[must_use]
    pub fn has_rule(&self, rule: TrajectorySuccessRule) -> bool {
        self.metric_values(TrajectoryMetric::SuccessRate, rule).any(|value| value.is_some())
    }

    /// Gives all scores to one instruction on one path, for tests.
    #[cfg(test)]
    pub(crate) fn of_one_path(scores: Vec<TrajectoryScore>) -> Self {
        let known = JudgedInstruction { name: "1_0".into(), item: 0, item_id: "1".into(), path: "a/1".into() };
        let rows =
            scores.into_iter().map(|score| ScoredTrajectory { instruction: 0, names_object: false, score }).collect();
        Self { instructions: [known].into(), rows }
    }

    fn rows_with_instructions(&self) -> impl Iterator<Item = (&JudgedInstruction, &ScoredTrajectory)> {
        self.rows.iter().map(|row| (&self.instructions[row.instruction], row))
    }
}

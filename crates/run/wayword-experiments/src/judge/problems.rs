//! The problems of a submission. Their number is limited, so that a hostile file cannot fill the memory.

use serde::Serialize;
use wayword_formats::submission;

/// Most problems that are kept, because a hostile file can hold millions. The others are only counted.
pub(super) const MAX_KEPT_PROBLEMS: usize = 100_000;

/// One problem of a submission.
#[derive(Debug, Clone, Serialize)]
pub struct TrajectoryProblem {
    /// The instruction; `None` for a problem of the file itself. Then `problem` contains the place in the file.
    pub instr_id: Option<String>,
    /// A description of the problem.
    pub problem: String,
}

/// The first 100,000 problems, and the number of the others.
#[derive(Debug, Default, Serialize)]
pub struct TrajectoryProblems {
    #[serde(rename = "problems")]
    /// The problems that are kept, in the order in which they were found.
    told: Vec<TrajectoryProblem>,
    /// The number of problems beyond those that are kept.
    untold: usize,
    /// How many of all problems are instructions without a trajectory.
    missing: usize,
}

impl TrajectoryProblem {
    pub(super) fn new(instr_id: String, problem: impl Into<String>) -> Self {
        Self { instr_id: Some(instr_id), problem: problem.into() }
    }
}

impl TrajectoryProblems {
    /// Takes over the problems of the file itself.
    #[must_use]
    pub fn from_file(found: &submission::SubmissionProblems) -> Self {
        let to_problem =
            |problem: &wayword_formats::FormatError| TrajectoryProblem { instr_id: None, problem: problem.to_string() };
        Self { told: found.listed.iter().map(to_problem).collect(), untold: found.unlisted_count, missing: 0 }
    }

    /// Appends other problems.
    pub(super) fn followed_by(mut self, other: Self) -> Self {
        let room = MAX_KEPT_PROBLEMS.saturating_sub(self.told.len());
        self.untold += other.untold + other.told.len().saturating_sub(room);
        self.missing += other.missing;
        self.told.extend(other.told.into_iter().take(room));
        self
    }

    /// Adds a problem for an instruction without a trajectory.
    pub(super) fn add_missing(&mut self, instr_id: String) {
        self.missing += 1;
        self.add(|| TrajectoryProblem::new(instr_id, "the submission has no trajectory for this instruction"));
    }

    /// Adds a problem. Beyond the limit it is only counted, and `problem` is not called.
    pub(super) fn add(&mut self, problem: impl FnOnce() -> TrajectoryProblem) {
        if self.told.len() < MAX_KEPT_PROBLEMS {
            self.told.push(problem());
        } else {
            self.leave_out();
        }
    }

    /// Counts a problem that is not kept.
    pub(super) fn leave_out(&mut self) {
        self.untold += 1;
    }

    /// The problems up to the limit.
    #[must_use]
    pub fn listed_problems(&self) -> &[TrajectoryProblem] {
        &self.told
    }

    /// The number of all problems.
    #[must_use]
    pub fn count(&self) -> usize {
        self.told.len() + self.untold
    }

    /// How many of them are instructions without a trajectory.
    #[must_use]
    pub fn missing_count(&self) -> usize {
        self.missing
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn problems_beyond_the_limit_are_counted_and_never_made() {
        let (mut problems, mut made) = (TrajectoryProblems::default(), 0);
        for _ in 0..MAX_KEPT_PROBLEMS + 5 {
            problems.add(|| {
                made += 1;
                TrajectoryProblem::new(String::new(), "it is missing")
            });
        }
        assert_eq!(
            (problems.told.len(), problems.untold, problems.count(), made),
            (MAX_KEPT_PROBLEMS, 5, MAX_KEPT_PROBLEMS + 5, MAX_KEPT_PROBLEMS)
        );
        let both = TrajectoryProblems::default().followed_by(problems);
        assert_eq!((both.told.len(), both.count()), (MAX_KEPT_PROBLEMS, MAX_KEPT_PROBLEMS + 5));
    }
}

//! The problems of a submission. Their number is limited, so that a hostile file cannot fill the memory.

use serde::Serialize;
use wayword_formats::submission;

/// Most problems that are kept; a hostile file can hold millions.
pub(super) const KEPT: usize = 100_000;

/// One problem of a submission.
#[derive(Debug, Clone, Serialize)]
pub struct Problem {
    /// The instruction; `None` for a problem of the file itself. Then `problem` contains the place in the file.
    pub instr_id: Option<String>,
    /// A description of the problem.
    pub problem: String,
}

/// The first 100,000 problems, and the number of the others.
#[derive(Debug, Default, Serialize)]
pub struct Problems {
    #[serde(rename = "problems")]
    told: Vec<Problem>,
    /// The number of problems beyond those that are kept.
    untold: usize,
    /// How many of all problems are instructions without a trajectory.
    missing: usize,
}

impl Problem {
    pub(super) fn new(instr_id: String, problem: impl Into<String>) -> Self {
        Self { instr_id: Some(instr_id), problem: problem.into() }
    }
}

impl Problems {
    /// Takes over the problems of the file itself.
    #[must_use]
    pub fn of_file(found: &submission::Problems) -> Self {
        let of_file = |problem: &wayword_formats::FormatError| Problem { instr_id: None, problem: problem.to_string() };
        Self { told: found.told.iter().map(of_file).collect(), untold: found.untold, missing: 0 }
    }

    /// Appends other problems.
    pub(super) fn and(mut self, other: Self) -> Self {
        let room = KEPT.saturating_sub(self.told.len());
        self.untold += other.untold + other.told.len().saturating_sub(room);
        self.missing += other.missing;
        self.told.extend(other.told.into_iter().take(room));
        self
    }

    /// Adds a problem for an instruction without a trajectory.
    pub(super) fn add_missing(&mut self, instr_id: String) {
        self.missing += 1;
        self.add(|| Problem::new(instr_id, "the submission has no trajectory for this instruction"));
    }

    /// Adds a problem. Beyond the limit it is only counted, and `problem` is not called.
    pub(super) fn add(&mut self, problem: impl FnOnce() -> Problem) {
        if self.told.len() < KEPT {
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
    pub fn told(&self) -> &[Problem] {
        &self.told
    }

    /// The number of all problems.
    #[must_use]
    pub fn count(&self) -> usize {
        self.told.len() + self.untold
    }

    /// How many of them are instructions without a trajectory.
    #[must_use]
    pub fn missing(&self) -> usize {
        self.missing
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn problems_beyond_the_limit_are_counted_and_never_made() {
        let (mut problems, mut made) = (Problems::default(), 0);
        for _ in 0..KEPT + 5 {
            problems.add(|| {
                made += 1;
                Problem::new(String::new(), "it is missing")
            });
        }
        assert_eq!((problems.told.len(), problems.untold, problems.count(), made), (KEPT, 5, KEPT + 5, KEPT));
        let both = Problems::default().and(problems);
        assert_eq!((both.told.len(), both.count()), (KEPT, KEPT + 5));
    }
}

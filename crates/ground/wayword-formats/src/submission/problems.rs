//! Collects all problems of a submission, so that a user can repair them in one go.

use crate::{FormatError, limits};

/// The problems of a file, in its order: the first thousand, and the number of the others.
#[derive(Debug, Default)]
pub struct SubmissionProblems {
    /// The problems that are listed one by one.
    pub told: Vec<FormatError>,
    /// The number of the others.
    pub untold: usize,
}

impl SubmissionProblems {
    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.told.len() + self.untold
    }

    pub(super) fn add_problem(&mut self, problem: FormatError) {
        if self.told.len() < limits::MAX_LISTED_PROBLEMS {
            self.told.push(problem);
        } else {
            self.untold += 1;
        }
    }

    /// The value of a success; a failure is added to the problems.
    pub(super) fn value_or_problem<T>(&mut self, found: Result<T, FormatError>) -> Option<T> {
        found.map_err(|problem| self.add_problem(problem)).ok()
    }
}

//! Collects all problems of a submission, so that a user can repair them in one go.

use crate::{FormatError, limits};

/// The problems of a file, in its order: the first thousand, and the number of the others.
#[derive(Debug, Default)]
pub struct SubmissionProblems {
    /// The problems that are listed one by one.
    pub listed: Vec<FormatError>,
    /// The number of the others.
    pub unlisted_count: usize,
}

impl SubmissionProblems {
    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.listed.len() + self.unlisted_count
    }

    pub(super) fn add_problem(&mut self, problem: FormatError) {
        if self.listed.len() < limits::MAX_LISTED_PROBLEMS {
            self.listed.push(problem);
        } else {
            self.unlisted_count += 1;
        }
    }

    /// The value of a success; a failure is added to the problems.
    pub(super) fn value_or_problem<T>(&mut self, found: Result<T, FormatError>) -> Option<T> {
        found.map_err(|problem| self.add_problem(problem)).ok()
    }
}

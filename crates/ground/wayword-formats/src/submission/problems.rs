//! Collects all problems of a submission, so that a user can repair them in one go.

use crate::{FormatError, limits};

/// The problems of a file, in its order: the first thousand, and the number of the others.
#[derive(Debug, Default)]
pub struct Problems {
    /// The problems that are listed one by one.
    pub told: Vec<FormatError>,
    /// The number of the others.
    pub untold: usize,
}

impl Problems {
    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.told.len() + self.untold
    }

    pub(super) fn add(&mut self, problem: FormatError) {
        if self.told.len() < limits::PROBLEMS {
            self.told.push(problem);
        } else {
            self.untold += 1;
        }
    }

    /// The value of a success; a failure is added to the problems.
    pub(super) fn good<T>(&mut self, found: Result<T, FormatError>) -> Option<T> {
        found.map_err(|problem| self.add(problem)).ok()
    }
}

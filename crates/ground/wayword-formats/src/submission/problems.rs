//! Everything that is wrong with a submission, instead of the first thing.

use crate::{FormatError, limits};

/// What is wrong with a file, in its order; the first thousand, and how many more there are.
#[derive(Debug, Default)]
pub struct Problems {
    /// What is told one by one.
    pub told: Vec<FormatError>,
    /// How many more there are.
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

    /// The value, where there is one; the problem is kept.
    pub(super) fn good<T>(&mut self, found: Result<T, FormatError>) -> Option<T> {
        found.map_err(|problem| self.add(problem)).ok()
    }
}

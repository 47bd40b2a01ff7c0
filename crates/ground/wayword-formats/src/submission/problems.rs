//! Everything that is wrong with a submission, instead of the first thing.

use crate::{FormatError, limits};
use std::fmt;

/// What is wrong with a file, in its order; the first thousand, and how many more there are.
#[derive(Debug, Default)]
pub struct Problems {
    /// What is told one by one.
    pub told: Vec<FormatError>,
    /// How many more there are.
    pub untold: usize,
}

/// A submission cannot be used: everything that is wrong with it, one line each.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct Refused(pub Problems);

impl Problems {
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

impl fmt::Display for Problems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, problem) in self.told.iter().enumerate() {
            write!(f, "{}{problem}", if index == 0 { "" } else { "\n" })?;
        }
        if self.untold > 0 { write!(f, "\nand {} more", self.untold) } else { Ok(()) }
    }
}

//! Why a submission is not scored: everything that is wrong with it.

use crate::error::Error;
use serde::Serialize;
use std::{fmt, path::Path};

/// Problems that are shown on a screen.
const SHOWN: usize = 20;
/// Most problems that are kept; a hostile file can hold millions.
const KEPT: usize = 100_000;

/// Something that is wrong.
#[derive(Debug, Serialize)]
pub(super) struct Problem {
    /// The instruction; none where the file itself is wrong, and says where.
    instr_id: Option<String>,
    problem: String,
}

/// A submission that is not scored.
#[derive(Debug, Serialize)]
pub(super) struct Refusal {
    submission: String,
    scored: usize,
    problems: Vec<Problem>,
    /// How many more there are than are told.
    untold: usize,
}

impl Problem {
    pub(super) fn new(instr_id: String, problem: impl Into<String>) -> Self {
        Self { instr_id: Some(instr_id), problem: problem.into() }
    }

    pub(super) fn of_file(problem: &str) -> Self {
        Self { instr_id: None, problem: problem.to_owned() }
    }
}

impl Refusal {
    pub(super) fn new(submission: &Path, mut problems: Vec<Problem>, untold: usize) -> Self {
        let untold = untold + problems.len().saturating_sub(KEPT);
        problems.truncate(KEPT);
        Self { submission: submission.display().to_string(), scored: 0, problems, untold }
    }

    fn all(&self) -> usize {
        self.problems.len() + self.untold
    }

    /// What ends the program.
    pub(super) fn into_error(self) -> Error {
        let problems = if self.all() == 1 { "1 problem".to_owned() } else { format!("{} problems", self.all()) };
        Error::usage(
            format!("{}: {problems}; nothing was scored", self.submission),
            "mend what is told; --json tells all of it",
        )
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Problem { instr_id, problem } in self.problems.iter().take(SHOWN) {
            // A file's keys are quoted, and may hold what a terminal obeys.
            let problem = problem.replace(char::is_control, "\u{fffd}");
            match instr_id {
                Some(instr_id) => writeln!(f, "{instr_id}: {problem}")?,
                None => writeln!(f, "{problem}")?,
            }
        }
        match self.all().saturating_sub(SHOWN) {
            0 => Ok(()),
            more => writeln!(f, "and {more} more"),
        }
    }
}

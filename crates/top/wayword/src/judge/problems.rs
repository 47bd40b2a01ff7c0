//! Why a submission is not scored: everything that is wrong with it.

use crate::{count::count, error::Error};
use serde::Serialize;
use std::{fmt, path::Path};
use wayword_formats::submission::{self, Reading};

/// Problems that are shown on a screen.
const SHOWN: usize = 20;
/// Most problems that are kept; a hostile file can hold millions.
const KEPT: usize = 100_000;

/// Something that is wrong.
#[derive(Debug, Serialize)]
pub(super) struct Problem {
    /// The instruction; `None` if the file itself is wrong, and `problem` says where.
    instr_id: Option<String>,
    problem: String,
}

/// What is wrong, up to [`KEPT`] problems.
#[derive(Debug, Default, Serialize)]
pub(super) struct Problems {
    #[serde(rename = "problems")]
    told: Vec<Problem>,
    /// How many more there are than are kept.
    untold: usize,
    /// How many of all are instructions without a trajectory.
    missing: usize,
}

/// A submission that is not scored.
#[derive(Debug, Serialize)]
pub(super) struct Refusal {
    submission: String,
    scored: usize,
    #[serde(flatten)]
    problems: Problems,
}

impl Problem {
    pub(super) fn new(instr_id: String, problem: impl Into<String>) -> Self {
        Self { instr_id: Some(instr_id), problem: problem.into() }
    }

    fn of_file(problem: &str) -> Self {
        Self { instr_id: None, problem: problem.to_owned() }
    }
}

impl Problems {
    /// What is wrong with the file itself.
    pub(super) fn of_file(found: &submission::Problems) -> Self {
        let told = found.told.iter().map(|problem| Problem::of_file(&problem.to_string())).collect();
        Self { told, untold: found.untold, missing: 0 }
    }

    /// Takes an instruction without a trajectory.
    pub(super) fn add_missing(&mut self, instr_id: String) {
        self.missing += 1;
        self.add(|| Problem::new(instr_id, "the submission has no trajectory for this instruction"));
    }

    /// Takes a problem; beyond the limit it is only counted, and not even made.
    pub(super) fn add(&mut self, problem: impl FnOnce() -> Problem) {
        if self.told.len() < KEPT {
            self.told.push(problem());
        } else {
            self.untold += 1;
        }
    }

    pub(super) fn count(&self) -> usize {
        self.told.len() + self.untold
    }
}

impl Refusal {
    pub(super) fn new(submission: &Path, problems: Problems) -> Self {
        Self { submission: submission.display().to_string(), scored: 0, problems }
    }

    /// What ends the program.
    pub(super) fn into_error(self) -> Error {
        let (all, missing) = (self.problems.count(), self.problems.missing);
        let problem = format!("{}: {}; nothing was scored", self.submission, count(all, "problem"));
        let without = count(missing, "instruction");
        Error::usage(
            problem,
            match all - missing {
                0 if missing > 0 => {
                    format!("add the trajectories of {without}, or score the others with --partial")
                }
                _ if missing > 0 => {
                    format!("fix the problems listed above; --partial skips {without} without a trajectory")
                }
                _ => "fix the problems listed above; --json lists more of them".to_owned(),
            },
        )
    }
}

/// The error for a file that is no submission, but something else that this program knows.
pub(super) fn no_submission(file: &Path, reading: &Reading) -> Option<Error> {
    const HINT: &str = "give what an agent walked: a JSON list of {\"instr_id\": ..., \"trajectory\": [...]}, see \
                        `wayword evaluate --help`";
    if file.is_dir() {
        let folder = file.join("submissions");
        let hint = if folder.is_dir() { format!("name one of the files in {}", folder.display()) } else { HINT.into() };
        return Some(Error::usage(format!("{}: it is a folder, not a submission", file.display()), hint));
    }
    if !reading.submitted.is_empty() || !reading.flawed.is_empty() {
        return None;
    }
    let format = wayword_formats::detect(file).ok()?;
    format.read(file).ok()?;
    let problem = format!("{}: it is a dataset (format {format}), not a submission", file.display());
    Some(Error::usage(problem, format!("{HINT}; give the dataset with --episodes")))
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for Problem { instr_id, problem } in self.problems.told.iter().take(SHOWN) {
            // The problem quotes keys of the file, which may hold control characters that a terminal obeys.
            let problem = problem.replace(char::is_control, "\u{fffd}");
            match instr_id {
                Some(instr_id) => writeln!(f, "{instr_id}: {problem}")?,
                None => writeln!(f, "{problem}")?,
            }
        }
        match self.problems.count().saturating_sub(SHOWN) {
            0 => Ok(()),
            more => writeln!(f, "and {more} more"),
        }
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
    }
}

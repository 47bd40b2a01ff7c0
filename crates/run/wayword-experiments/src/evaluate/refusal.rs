//! A submission that is not scored because of its problems: what the screen shows, and the error that ends the program.

use crate::judge::{TrajectoryProblem, TrajectoryProblems};
use serde::Serialize;
use std::{fmt, path::Path};
use wayword_formats::submission::SubmissionReading;
use wayword_run::{count::count_phrase, error::CommandError};

/// Most problems that the screen shows. It only counts the others; `--json` lists more of them.
const MAX_SHOWN_PROBLEMS: usize = 20;

/// A submission that is not scored, with its problems.
#[derive(Debug, Serialize)]
pub(super) struct SubmissionRefusal {
    submission: String,
    /// How many trajectories were scored: always 0, because a submission with problems is not scored.
    scored: usize,
    #[serde(flatten)]
    problems: TrajectoryProblems,
}

impl SubmissionRefusal {
    pub(super) fn new(submission: &Path, problems: TrajectoryProblems) -> Self {
        Self { submission: submission.display().to_string(), scored: 0, problems }
    }

    /// The error that ends the program.
    pub(super) fn into_error(self) -> CommandError {
        let (all, missing) = (self.problems.count(), self.problems.missing_count());
        let problem = format!("{}: {}; nothing was scored", self.submission, count_phrase(all, "problem"));
        let without = count_phrase(missing, "instruction");
        CommandError::usage(
            problem,
            match all - missing {
                0 if missing > 0 => {
                    format!("add the trajectories of {without}, or score the others with --partial")
                }
                _ if missing > 0 => {
                    format!("fix the problems listed above; --partial skips {without} without a trajectory")
                }
                _ if all > MAX_SHOWN_PROBLEMS => "fix the problems listed above; --json lists more of them".to_owned(),
                _ => "fix what is listed above".to_owned(),
            },
        )
    }
}

/// The error for a file that is not a submission, but a folder or a dataset that this program can read.
pub(super) fn wrong_file_error(file: &Path, reading: &SubmissionReading) -> Option<CommandError> {
    const HINT: &str = "give what an agent walked: a JSON list of {\"instr_id\": ..., \"trajectory\": [...]}, see \
                        `wayword evaluate --help`";
    if file.is_dir() {
        let folder = file.join("submissions");
        let hint = if folder.is_dir() { format!("name one of the files in {}", folder.display()) } else { HINT.into() };
        return Some(CommandError::usage(format!("{}: it is a folder, not a submission", file.display()), hint));
    }
    if !reading.submitted.is_empty() {
        return None;
    }
    if reading.is_whole && reading.flawed.is_empty() && reading.problems.count() == 0 {
        let problem =
            format!("{}: it is an empty list: no instruction has a trajectory; nothing was scored", file.display());
        return Some(CommandError::usage(problem, HINT));
    }
    let format = wayword_formats::detect_format(file).ok()?;
    format.read_file(file).ok()?;
    let problem = format!("{}: it is a dataset (format {format}), not a submission", file.display());
    Some(CommandError::usage(problem, format!("{HINT}; give the dataset with --episodes")))
}

impl fmt::Display for SubmissionRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for TrajectoryProblem { instr_id, problem } in self.problems.listed_problems().iter().take(MAX_SHOWN_PROBLEMS) {
            // The problem quotes keys of the file, which may hold control characters that a terminal obeys.
            let problem = problem.replace(char::is_control, "\u{fffd}");
            match instr_id {
                Some(instr_id) => writeln!(f, "{instr_id}: {problem}")?,
                None => writeln!(f, "{problem}")?,
            }
        }
        match self.problems.count().saturating_sub(MAX_SHOWN_PROBLEMS) {
            0 => Ok(()),
            more => writeln!(f, "and {more} more"),
        }
    }
}

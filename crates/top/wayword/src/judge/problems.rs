//! What is wrong with a submission.

use serde::Serialize;
use wayword_formats::submission;

/// Most problems that are kept; a hostile file can hold millions.
pub(super) const KEPT: usize = 100_000;

/// Something that is wrong.
#[derive(Debug, Clone, Serialize)]
pub struct Problem {
    /// The instruction; `None` if the file itself is wrong, and `problem` says where.
    pub instr_id: Option<String>,
    /// What is wrong with it.
    pub problem: String,
}

/// What is wrong, up to 100,000 problems.
#[derive(Debug, Default, Serialize)]
pub struct Problems {
    #[serde(rename = "problems")]
    told: Vec<Problem>,
    /// How many more there are than are kept.
    untold: usize,
    /// How many of all are instructions without a trajectory.
    missing: usize,
}

impl Problem {
    pub(super) fn new(instr_id: String, problem: impl Into<String>) -> Self {
        Self { instr_id: Some(instr_id), problem: problem.into() }
    }
}

impl Problems {
    /// What is wrong with the file itself.
    #[must_use]
    pub fn of_file(found: &submission::Problems) -> Self {
        let of_file = |problem: &wayword_formats::FormatError| Problem { instr_id: None, problem: problem.to_string() };
        Self { told: found.told.iter().map(of_file).collect(), untold: found.untold, missing: 0 }
    }

    /// These problems, and then others.
    pub(super) fn and(mut self, other: Self) -> Self {
        let room = KEPT.saturating_sub(self.told.len());
        self.untold += other.untold + other.told.len().saturating_sub(room);
        self.missing += other.missing;
        self.told.extend(other.told.into_iter().take(room));
        self
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
            self.leave_out();
        }
    }

    /// Counts a problem that is not kept.
    pub(super) fn leave_out(&mut self) {
        self.untold += 1;
    }

    /// Those that are kept.
    #[must_use]
    pub fn told(&self) -> &[Problem] {
        &self.told
    }

    /// How many there are.
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

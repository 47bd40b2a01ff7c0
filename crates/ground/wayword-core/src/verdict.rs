//! The outcomes of checks: one verdict per check, and one for the whole text.

use serde::{Deserialize, Serialize};

/// The outcome of one check, or of all of them together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Checked against evidence, and right.
    Pass,
    /// No evidence decides it.
    Unverified,
    /// Checked, and wrong.
    Fail,
}

/// The rules that a text is checked by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CheckKind {
    /// Sentences and words, as the style demands.
    Form,
    /// The text ends in a task on an object of the final viewpoint.
    Task,
    /// Each landmark has evidence at a frame of the path.
    Landmarks,
    /// Landmarks and turns come in the order of the path.
    Order,
    /// Each turn word agrees with a move.
    Turns,
    /// Storeys and stairs agree with the path.
    Floors,
    /// The text leads along its path, and not elsewhere.
    Route,
    /// The program understands all clauses of the text.
    Coverage,
    /// No long run of words is shared with the references, and no shorter one that is not common.
    Leak,
}

/// One check's outcome, with its reason where it did not pass.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct CheckFinding {
    /// Which check.
    pub check: CheckKind,
    /// Its outcome.
    pub verdict: Verdict,
    /// Why, in a sentence; empty where it passed.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub reason: String,
    /// The words it is about, where it is about some: byte range in the text.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub span: Option<[usize; 2]>,
}

impl CheckKind {
    /// All of them, in the order in which they are listed.
    pub const ALL: [Self; 9] = [
        Self::Form,
        Self::Task,
        Self::Landmarks,
        Self::Order,
        Self::Turns,
        Self::Floors,
        Self::Route,
        Self::Coverage,
        Self::Leak,
    ];

    /// Its name, in files and on the screen.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Form => "form",
            Self::Task => "task",
            Self::Landmarks => "landmarks",
            Self::Order => "order",
            Self::Turns => "turns",
            Self::Floors => "floors",
            Self::Route => "route",
            Self::Coverage => "coverage",
            Self::Leak => "leak",
        }
    }
}

impl Verdict {
    /// The verdict on a whole text: the worst of its checks. A text without checks is unverified.
    #[must_use]
    pub fn from_findings(findings: &[CheckFinding]) -> Self {
        findings.iter().map(|finding| finding.verdict).max().unwrap_or(Self::Unverified)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_as_good_as_its_worst_check() {
        let finding = |verdict| CheckFinding { check: CheckKind::Turns, verdict, reason: String::new(), span: None };
        assert_eq!(Verdict::from_findings(&[]), Verdict::Unverified);
        assert_eq!(
            Verdict::from_findings(&[finding(Verdict::Pass), finding(Verdict::Unverified)]),
            Verdict::Unverified
        );
        assert_eq!(Verdict::from_findings(&[finding(Verdict::Pass), finding(Verdict::Fail)]), Verdict::Fail);
    }
}

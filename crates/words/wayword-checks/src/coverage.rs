//! Checks that the program can read the text: clauses that the reader did not understand, and languages that it does
//! not know.

use super::{new_finding, pass_finding};
use wayword_core::{CheckFinding, CheckKind, Verdict};
use wayword_language::{Language, reading::TextReading};

/// The parts of a text that were not understood. A text with any is unverified, however right the rest is. `language`
/// is that of its words, or the one that its file names.
pub(super) fn check_coverage(reading: &TextReading, language: Language) -> Vec<CheckFinding> {
    if let Language::Other(name) = language {
        let reason = format!("the text is in {name}, and the program reads English");
        return vec![new_finding(CheckKind::Coverage, Verdict::Unverified, reason, None)];
    }
    let mut findings = Vec::new();
    if let Language::Partly(name) = language {
        let reason = format!("a part of the text is in {name}, and the program reads English");
        findings.push(new_finding(CheckKind::Coverage, Verdict::Unverified, reason, None));
    }
    for clause in reading.clauses.iter().filter(|clause| !clause.understood) {
        let reason = "the program does not understand this";
        findings.push(new_finding(CheckKind::Coverage, Verdict::Unverified, reason, Some(clause.span)));
    }
    if findings.is_empty() { vec![pass_finding(CheckKind::Coverage)] } else { findings }
}

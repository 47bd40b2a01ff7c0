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

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use wayword_language::reading::read_instruction;

    fn findings(text: &str, language: Language) -> Vec<(Verdict, String, Option<String>)> {
        let reading = read_instruction(text, &BTreeSet::new());
        let of = |finding: CheckFinding| {
            assert_eq!(finding.check, CheckKind::Coverage);
            (finding.verdict, finding.reason, finding.span.map(|[from, to]| text[from..to].to_owned()))
        };
        check_coverage(&reading, language).into_iter().map(of).collect()
    }

    #[test]
    fn check_coverage_passes_what_is_understood_and_lists_the_rest() {
        let pass = (Verdict::Pass, String::new(), None);
        assert_eq!(findings("Walk past the sofa and stop.", Language::English), [pass]);
        let unclear = findings("Walk past the sofa. Frobnicate the quux bazingly.", Language::English);
        assert_eq!(unclear.len(), 1, "{unclear:?}");
        assert_eq!(
            (unclear[0].0, unclear[0].1.as_str()),
            (Verdict::Unverified, "the program does not understand this")
        );
        assert!(unclear[0].2.as_ref().is_some_and(|words| words.contains("Frobnicate")), "{unclear:?}");
    }

    #[test]
    fn check_coverage_names_a_foreign_language() {
        let text = "Walk past the sofa and stop.";
        let whole = "the text is in Hindi, and the program reads English".to_owned();
        assert_eq!(findings(text, Language::Other("Hindi")), [(Verdict::Unverified, whole, None)]);
        let part = "a part of the text is in Hindi, and the program reads English".to_owned();
        assert_eq!(findings(text, Language::Partly("Hindi")), [(Verdict::Unverified, part, None)]);
    }
}

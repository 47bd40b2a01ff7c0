//! Checks the numbers of sentences and words that the style demands.

use super::{findings_or_pass, new_finding};
use wayword_core::{CheckFinding, CheckKind, StyleConstraints, Verdict};
use wayword_language::{reading::TextReading, text::word_count};

/// The findings about the length of a text: a pass if it keeps all limits of its style.
pub(super) fn check_form(text: &str, reading: &TextReading, constraints: &StyleConstraints) -> Vec<CheckFinding> {
    let (sentences, words) = (reading.count_sentences(), word_count(text));
    let counted = |count: usize, noun: &str| format!("{count} {noun}{}", if count == 1 { "" } else { "s" });
    let mut wrong = Vec::new();
    let mut fail = |reason: String| wrong.push(new_finding(CheckKind::Form, Verdict::Fail, reason, None));
    if words == 0 {
        fail("it has no words".into());
    }
    if let Some(least) = constraints.min_sentences.filter(|least| sentences < *least) {
        fail(format!("{} where the style asks for {least} or more", counted(sentences, "sentence")));
    }
    if let Some(most) = constraints.max_sentences.filter(|most| sentences > *most) {
        fail(format!("{} where the style asks for {most} at most", counted(sentences, "sentence")));
    }
    if let Some(limit) = constraints.fewer_words_than.filter(|limit| words >= *limit) {
        fail(format!("{} where the style asks for fewer than {limit}", counted(words, "word")));
    }
    findings_or_pass(CheckKind::Form, wrong)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use wayword_language::reading::read_instruction;

    fn findings(text: &str, constraints: &StyleConstraints) -> Vec<CheckFinding> {
        check_form(text, &read_instruction(text, &BTreeSet::new()), constraints)
    }

    fn reasons(text: &str, constraints: &StyleConstraints) -> Vec<String> {
        let wrong = findings(text, constraints).into_iter().filter(|finding| finding.verdict == Verdict::Fail);
        wrong.map(|finding| finding.reason).collect()
    }

    #[test]
    fn sentences_and_words_have_their_limits() {
        let none = StyleConstraints::default();
        let least = |min: usize| StyleConstraints { min_sentences: Some(min), ..none.clone() };
        let most = |max: usize| StyleConstraints { max_sentences: Some(max), ..none.clone() };
        let fewer = |limit: usize| StyleConstraints { fewer_words_than: Some(limit), ..none.clone() };
        let text = "Walk on. Stop here now.";
        for right in [&none, &least(1), &least(2), &most(2), &most(3), &fewer(6)] {
            assert!(reasons(text, right).is_empty(), "{right:?}");
        }
        assert_eq!(reasons(text, &least(3)), ["2 sentences where the style asks for 3 or more"]);
        assert_eq!(reasons(text, &most(1)), ["2 sentences where the style asks for 1 at most"]);
        assert_eq!(reasons(text, &fewer(5)), ["5 words where the style asks for fewer than 5"]);
        assert_eq!(reasons("Stop.", &least(2)), ["1 sentence where the style asks for 2 or more"]);
        assert_eq!(reasons("Stop.", &fewer(1)), ["1 word where the style asks for fewer than 1"]);
    }

    #[test]
    fn a_text_without_words_fails() {
        assert_eq!(reasons("", &StyleConstraints::default()), ["it has no words"]);
        assert_eq!(reasons(" ... ", &StyleConstraints::default()), ["it has no words"]);
        let passed = findings("Stop.", &StyleConstraints::default());
        assert_eq!((passed.len(), passed[0].check, passed[0].verdict), (1, CheckKind::Form, Verdict::Pass));
    }
}

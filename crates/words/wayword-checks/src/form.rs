//! Checks the numbers of sentences and words that the style demands.

use super::{new_finding, or_pass};
use wayword_core::{CheckFinding, CheckKind, StyleConstraints, Verdict};
use wayword_language::text::{sentence_count, word_count};

pub(super) fn check_form(text: &str, constraints: &StyleConstraints) -> Vec<CheckFinding> {
    let (sentences, words) = (sentence_count(text), word_count(text));
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
    or_pass(CheckKind::Form, wrong)
}

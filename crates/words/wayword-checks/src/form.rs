//! Checks the numbers of sentences and words that the style demands.

use super::{findings_or_pass, new_finding};
use std::collections::BTreeSet;
use wayword_core::{CheckFinding, CheckKind, InstructionStyle, Verdict};
use wayword_language::reading::TextReading;

/// A text is far from a wanted number of words where it differs by more than this share of the number, and by more than
/// [`FAR_WORDS`].
const FAR_SHARE: f64 = 0.5;
/// A difference of so many words is never far.
const FAR_WORDS: usize = 5;

/// The findings about the length of a text: a pass if it keeps all limits of its style, and is not far from the lengths that
/// the style gives. `words` is its number of words.
pub(super) fn check_form(words: usize, reading: &TextReading, style: &InstructionStyle) -> Vec<CheckFinding> {
    let constraints = &style.constraints;
    let sentences = reading.count_sentences();
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
    // The numbers are a wish, and a way may need more words: no text fails by them, and none passes that is far from all.
    if wrong.is_empty() && is_far_from_all(words, &style.words) {
        let reason =
            format!("the text has {}, and the style asks for {}", counted(words, "word"), list_numbers(&style.words));
        wrong.push(new_finding(CheckKind::Form, Verdict::Unverified, reason, None));
    }
    findings_or_pass(CheckKind::Form, wrong)
}

/// Whether a number of words is far from each of the wanted numbers. Where none is wanted, it is not.
fn is_far_from_all(words: usize, wanted: &[usize]) -> bool {
    let is_far = |wanted: &usize| {
        let apart = words.abs_diff(*wanted);
        apart > FAR_WORDS && apart as f64 > FAR_SHARE * *wanted as f64
    };
    !wanted.is_empty() && wanted.iter().all(is_far)
}

/// Three numbers or fewer, or the range of more.
fn list_numbers(numbers: &[usize]) -> String {
    let different: Vec<usize> = numbers.iter().copied().collect::<BTreeSet<_>>().into_iter().collect();
    match different.as_slice() {
        [one] => one.to_string(),
        [one, other] => format!("{one} or {other}"),
        [one, other, third] => format!("{one}, {other} or {third}"),
        [least, .., most] => format!("{least} to {most}"),
        [] => "none".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::StyleConstraints;
    use wayword_language::{reading::read_instruction, text::word_count};

    fn findings(text: &str, constraints: &StyleConstraints) -> Vec<CheckFinding> {
        let style = InstructionStyle { constraints: constraints.clone(), ..InstructionStyle::default() };
        check_form(word_count(text), &read_instruction(text, &BTreeSet::new()), &style)
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

    #[test]
    fn a_text_far_from_each_wanted_number_of_words_is_unverified() {
        let reason = |count: usize, wanted: &[usize], constraints: StyleConstraints| {
            let style = InstructionStyle { words: wanted.to_vec(), constraints, ..InstructionStyle::default() };
            let text = format!("{}stop.", "walk ".repeat(count - 1));
            let mut found = check_form(word_count(&text), &read_instruction(&text, &BTreeSet::new()), &style);
            assert_eq!(found.len(), 1, "{found:?}");
            let CheckFinding { verdict, reason, .. } = found.remove(0);
            (verdict, reason)
        };
        let free = StyleConstraints::default;
        // Half as much again, or five words, are near.
        for (count, wanted) in
            [(7, [2].as_slice()), (12, &[8]), (18, &[4, 12]), (15, &[30]), (3, &[8]), (90, &[]), (1, &[0])]
        {
            assert_eq!(reason(count, wanted, free()).0, Verdict::Pass, "{count} of {wanted:?}");
        }
        for (count, wanted, told) in [
            (35, [2].as_slice(), "the text has 35 words, and the style asks for 2"),
            (8, &[2], "the text has 8 words, and the style asks for 2"),
            (80, &[4000], "the text has 80 words, and the style asks for 4000"),
            (25, &[10, 60, 10], "the text has 25 words, and the style asks for 10 or 60"),
            (1, &[8, 10, 12], "the text has 1 word, and the style asks for 8, 10 or 12"),
            (31, &[7, 8, 12, 19], "the text has 31 words, and the style asks for 7 to 19"),
        ] {
            assert_eq!(reason(count, wanted, free()), (Verdict::Unverified, told.to_owned()));
        }
        // A rule that the text breaks is the only reason.
        let fewer = StyleConstraints { fewer_words_than: Some(20), ..free() };
        assert_eq!(reason(35, &[7], fewer), (Verdict::Fail, "35 words where the style asks for fewer than 20".into()));
    }
}

//! Words copied from the reference texts.

use super::{finding, pass};
use std::collections::BTreeSet;
use wayword_core::{Check, Finding, Verdict};
use wayword_language::{
    reading::vocabulary::STOCK,
    text::{Token, tokens},
};

/// A run of this many words that a text shares with a reference is a copy, unless it is a stock phrase ("at the end of
/// the"): one that has only words that every text needs.
pub const SHARED_RUN: usize = 5;

pub(super) fn leak(text: &str, references: &[String]) -> Finding {
    match shared_run(text, references) {
        None => pass(Check::Leak),
        Some(span) => {
            let reason = format!("{:?} is in a reference text too", &text[span[0]..span[1]]);
            finding(Check::Leak, Verdict::Fail, reason, Some(span))
        }
    }
}

/// The byte range of the first run of [`SHARED_RUN`] words that a text shares with any of the references and that is no stock
/// phrase.
#[must_use]
pub fn shared_run(text: &str, references: &[String]) -> Option<[usize; 2]> {
    let word_tokens = |text: &str| tokens(text).into_iter().filter(Token::is_word).collect::<Vec<_>>();
    let run = |run: &[Token]| run.iter().map(|token| token.word.clone()).collect::<Vec<_>>();
    let known: BTreeSet<Vec<String>> = references
        .iter()
        .flat_map(|reference| word_tokens(reference).windows(SHARED_RUN).map(run).collect::<Vec<_>>())
        .collect();
    let words = word_tokens(text);
    let says_something = |words: &[Token]| words.iter().any(|token| !STOCK.contains(&token.word.as_str()));
    let shared = words.windows(SHARED_RUN).find(|words| says_something(words) && known.contains(&run(words)))?;
    Some([shared[0].span[0], shared[SHARED_RUN - 1].span[1]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_words_in_a_row_are_a_copy_and_four_are_not() {
        let references = vec!["Walk past the old oak table, then stop.".to_owned()];
        let text = "Now walk past the old oak door";
        assert_eq!(shared_run(text, &references).map(|span| &text[span[0]..span[1]]), Some("walk past the old oak"));
        assert_eq!(shared_run("walk past the old door", &references), None);
        assert!(shared_run("the old oak table then", &references).is_some());
    }

    #[test]
    fn a_stock_phrase_of_function_words_is_no_copy_and_one_with_content_is() {
        let references = vec!["Wait at the end of the hallway, to the left of the oak door.".to_owned()];
        for text in ["Stop at the end of the rug.", "Stop to the left of the bed.", "It is at the end of the."] {
            assert_eq!(shared_run(text, &references), None, "{text}");
        }
        let text = "Stop at the end of the hallway.";
        let copied = shared_run(text, &references).map(|span| &text[span[0]..span[1]]);
        assert_eq!(copied, Some("the end of the hallway"));
    }
}

//! Finds the words of a motion: its verb, and the place that it goes along or past.

use wayword_language::{reading::motion_words::MOTION_VERBS, text::TextToken};

/// How far before the place of a motion its verb may be, words.
const VERB_REACH_WORDS: usize = 5;
/// How far behind a verb its noun may be, words.
const NOUN_REACH_WORDS: usize = 5;

/// The byte range from a motion's verb to the end of the place's name, or to its noun behind: "walk past the sofa",
/// "walk up the stairs". `noun` decides which words are that noun.
pub(super) fn motion_span(tokens: &[TextToken], span: [usize; 2], noun: impl Fn(&str) -> bool) -> [usize; 2] {
    let first = tokens.partition_point(|token| token.span[0] < span[0]);
    let goes_on =
        |token: &&TextToken| token.is_word() && !matches!(token.word.as_str(), "and" | "then" | "or" | "until");
    let before = tokens[..first].iter().rev().take_while(goes_on).take(VERB_REACH_WORDS);
    let verb = before.into_iter().find(|token| MOTION_VERBS.contains(&token.word.as_str()));
    let behind = tokens[first..].iter().take_while(goes_on).take(NOUN_REACH_WORDS);
    let named = behind.into_iter().find(|token| noun(&token.word));
    let begin = verb.map_or(span[0], |token| token.span[0]);
    [begin, named.map_or(span[1], |token| token.span[1].max(span[1]))]
}

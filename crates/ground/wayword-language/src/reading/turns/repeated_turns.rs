//! Finds turns that are made more than once: "turn right twice", "take two lefts".

use crate::reading::{numbers::cardinal_number, tokens::TokenSlice, vocabulary as v};

/// Most turns that one word means. More of them would lead in circles.
const MAX_TURNS_PER_WORD: usize = 4;

/// How many further turns the words give, and the first and the last token of their number ("twice"). The turn's own
/// tokens are `first` to `last`.
pub(super) fn more_turns(tokens: TokenSlice<'_>, first: usize, last: usize) -> (usize, (usize, usize)) {
    let next = last + 1 + usize::from(matches!(tokens.word_at(last + 1), "turn" | "turns"));
    let (times, number_tokens) = match (tokens.word_at(next), tokens.word_at(next + 1)) {
        ("twice", _) => (2, (next, next)),
        ("thrice", _) => (3, (next, next)),
        (number, "times") => (count_from_word(number), (next, next + 1)),
        _ => (count_before_turn(tokens, first, last), (first, last)),
    };
    (times.clamp(1, MAX_TURNS_PER_WORD) - 1, number_tokens)
}

/// The number that a word counts; 1 where it counts nothing.
fn count_from_word(word: &str) -> usize {
    cardinal_number(word).map_or(1, |number| number as usize)
}

/// The number before a turn: "two left turns", "two quick lefts", but not "two left doors".
fn count_before_turn(tokens: TokenSlice<'_>, first: usize, last: usize) -> usize {
    let several = matches!(tokens.word_at(first), "lefts" | "rights") || tokens.word_at(last + 1) == "turns";
    let before = (first.saturating_sub(2)..first).rev().map(|at| tokens.word_at(at));
    let mut numbers = before.take_while(|word| is_count(word) || v::BEFORE_SIDE.contains(word));
    if several { numbers.find_map(cardinal_number).map_or(1, |number| number as usize) } else { 1 }
}

/// Whether a word before a side may count turns, or may come between a number and the side.
pub(super) fn is_count(word: &str) -> bool {
    cardinal_number(word).is_some()
        || matches!(word, "quick" | "more" | "immediate" | "sharp" | "slight" | "consecutive")
}

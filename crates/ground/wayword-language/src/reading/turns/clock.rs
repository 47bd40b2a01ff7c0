//! Finds turns by the clock: "turn clockwise", "turn to your 3 o'clock".

use crate::reading::{numbers::cardinal_number, tokens::TokenSlice, vocabulary as v};
use wayword_core::Side;

/// The side of the turn that a token means, its verb and its last token. `from` is the first of the words that may come
/// between the verb and the token.
pub(super) fn clock_turn(tokens: TokenSlice<'_>, from: usize, at: usize) -> Option<(Side, Option<usize>, usize)> {
    let spins = |verb: &usize| v::SPINNING.contains(&tokens.word_at(*verb));
    let (side, last) = match tokens.word_at(at) {
        word @ ("clockwise" | "counterclockwise" | "anticlockwise") => {
            // "Counter clockwise" in two words.
            let split = matches!(tokens.word_before(at), "counter" | "anti");
            let first = at - usize::from(split);
            let from = if split { first - gap_words(tokens, first) } else { from };
            let verb = from.checked_sub(1).filter(spins)?;
            let is_number = |at: &usize| tokens.word_at(*at).parse::<f64>().is_ok_and(f64::is_finite);
            let behind = (at + 1..at + 3).find(is_number);
            let degrees = behind.or_else(|| (verb + 1..first).find(is_number));
            let degrees = degrees.and_then(|at| tokens.word_at(at).parse().ok()).unwrap_or(90.0);
            let side = side_after_turn(degrees, split || word != "clockwise")?;
            return Some((side, Some(verb), behind.unwrap_or(at)));
        }
        "o'clock" | "o’clock" | "oclock" => (side_at_hour(tokens.word_before(at))?, at),
        _ => return None,
    };
    let hour = at - 1;
    let verb = (hour - gap_words(tokens, hour)).checked_sub(1).filter(spins)?;
    Some((side, Some(verb), last))
}

/// How many words right before a token may come between a verb and it.
fn gap_words(tokens: TokenSlice<'_>, at: usize) -> usize {
    const MAX_GAP_WORDS: usize = 4;
    let is_number = |word: &str| word.parse::<f64>().is_ok();
    let can_come_between = |word: &str| {
        v::BEFORE_SIDE.contains(&word) || v::BEFORE_SIDE_OF_TURN.contains(&word) || word == "at" || is_number(word)
    };
    (0..at).rev().take(MAX_GAP_WORDS).take_while(|at| can_come_between(tokens.word_at(*at))).count()
}

/// The side on which one looks after a turn of that many degrees; `None` after a full one.
fn side_after_turn(degrees: f64, is_counterclockwise: bool) -> Option<Side> {
    match (degrees, is_counterclockwise) {
        (150.0..210.0, _) => Some(Side::Behind),
        (330.0.., _) => None,
        (..180.0, false) | (180.0.., true) => Some(Side::Right),
        _ => Some(Side::Left),
    }
}

/// The side of an hour on a clock that the walker faces: 3 is to the right. `None` for 11, 12 and 1, which are ahead.
fn side_at_hour(word: &str) -> Option<Side> {
    match cardinal_number(word)? {
        2..=4 => Some(Side::Right),
        5..=7 => Some(Side::Behind),
        8..=10 => Some(Side::Left),
        _ => None,
    }
}

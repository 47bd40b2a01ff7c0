//! Finds the side of the walker on which a text locates a place.

use super::{tokens::TokenSlice, vocabulary as v};
use wayword_core::Side;

/// How far before a place its side may be, words.
const SIDE_REACH_WORDS: usize = 10;

/// The side that follows a place ("on your left", "that is on the far right", but not "to the right of"), and the token
/// behind it. That is `to` where no side follows.
pub(super) fn side_after(tokens: TokenSlice<'_>, to: usize) -> (Option<Side>, usize) {
    let word = |at: usize| tokens.word_at(at);
    let mut at = to;
    while matches!(word(at), "that" | "is" | "are" | "which") {
        at += 1;
    }
    let owned = matches!(word(at), "on" | "to" | "at") && matches!(word(at + 1), "the" | "your");
    let bare = word(at) == "on" && side_from_word(word(at + 1)).is_some();
    if !(owned || bare) {
        return (None, to);
    }
    let at = if bare { at + 1 } else { at + 2 };
    let at = at + usize::from(is_exact(word(at)));
    let Some(side) = side_from_word(word(at)) else { return (None, to) };
    let end = behind_side(tokens, at);
    if word(end) == "of" { (None, to) } else { (Some(side), end) }
}

/// The side that is named before a place: "on your left is the sofa", "to the right you will see a sofa".
pub(super) fn side_before(tokens: TokenSlice<'_>, from: usize) -> Option<Side> {
    let word = |at: usize| tokens.word_at(at);
    let can_come_between = |word: &str| {
        v::DETERMINERS.contains(&word)
            || v::ADJECTIVES.contains(&word) && side_from_word(word).is_none()
            || matches!(word, "there" | "you" | "will" | "should" | "you'll" | "you’ll" | "," | "can")
    };
    let locates = |word: &str| {
        matches!(word, "is" | "are" | "be" | "see" | "find" | "notice" | "have" | "there's" | "there’s" | "comes")
    };
    let first = from.saturating_sub(SIDE_REACH_WORDS);
    let at = (first..from).rev().find(|at| !can_come_between(word(*at)) && !locates(word(*at)))?;
    if !(at..from).any(|at| locates(word(at))) {
        return None;
    }
    let at = if matches!(word(at), "side" | "hand") { at.checked_sub(1)? } else { at };
    let at = if word(at) == "hand" { at.checked_sub(1)? } else { at };
    let side = side_from_word(word(at))?;
    let at = at.checked_sub(1)?;
    let at = if is_exact(word(at)) { at.checked_sub(1)? } else { at };
    let preposition = at.checked_sub(1).filter(|_| matches!(word(at), "the" | "your"))?;
    let begins = preposition == 0
        || !tokens.is_word(preposition - 1)
        || matches!(word(preposition - 1), "and" | "then" | "where" | "so");
    (begins && matches!(word(preposition), "on" | "to" | "at")).then_some(side)
}

fn side_from_word(word: &str) -> Option<Side> {
    match word {
        "left" => Some(Side::Left),
        "right" => Some(Side::Right),
        _ => None,
    }
}

/// Whether a word between "on the" and the side only makes the side exact: "on the far left".
fn is_exact(word: &str) -> bool {
    matches!(word, "immediate" | "far" | "near" | "extreme" | "direct")
}

/// The token behind a side: "left", "left side", "left hand side".
fn behind_side(tokens: TokenSlice<'_>, at: usize) -> usize {
    let at = at + 1 + usize::from(tokens.word_at(at + 1) == "hand");
    at + usize::from(tokens.word_at(at) == "side")
}

#[cfg(test)]
mod tests {
    use crate::reading::places::first;
    use wayword_core::Side;

    #[test]
    fn sides_are_found_before_and_behind_a_place() {
        for text in [
            "pass the sofa on your left",
            "the sofa is on the left",
            "the sofa to your immediate left",
            "enter the kitchen on the left hand side",
            "the kitchen that is on the far left",
            "take the door on left",
            "on your left is the old sofa",
            "On the left side, there is a sofa.",
            "Walk on and to your left you will see a sofa.",
        ] {
            assert_eq!(first(text).side, Some(Side::Left), "{text}");
        }
        for text in [
            "the sofa to the left of the bed",
            "the sofa on the left side of the bed",
            "turn to the left, there is a sofa",
            "on your left walk to the sofa",
            "turn left at the sofa",
            "left of the bed is the sofa",
        ] {
            assert_eq!(first(text).side, None, "{text}");
        }
    }
}

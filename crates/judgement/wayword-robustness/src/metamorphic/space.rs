//! Checks for mirrored and turned worlds.

use super::{AnnotatedText, ExpectationOutcome};
use wayword_language::text::split_tokens;

/// Checks that the text in a turned world is the same, byte for byte.
#[must_use]
pub fn check_turned_world(base: AnnotatedText<'_>, changed: AnnotatedText<'_>) -> ExpectationOutcome {
    ExpectationOutcome::from_equal_texts(base.text, changed.text)
}

/// Checks that in a mirrored world left and right have changed places in the text, and all other words are the same.
#[must_use]
pub fn check_mirrored_world(base: AnnotatedText<'_>, changed: AnnotatedText<'_>) -> ExpectationOutcome {
    ExpectationOutcome::from_equal_texts(&with_sides_swapped(base.text), changed.text)
}

/// Endings after "left" or "right" that still make a word for a side ("rightmost", "left-hand").
const SIDE_WORD_ENDINGS: [&str; 6] = ["", "most", "hand", "ward", "wards", "side"];
/// Words after "right" with which it means "just" and no side ("right before the stairs").
const WORDS_AFTER_JUST: [&str; 10] =
    ["before", "next", "behind", "beside", "outside", "inside", "there", "here", "away", "across"];

/// Replaces each word for a side by the word for the other side.
fn with_sides_swapped(text: &str) -> String {
    let tokens = split_tokens(text);
    let (mut swapped, mut from) = (String::new(), 0);
    for (at, token) in tokens.iter().enumerate() {
        let word = &text[token.span[0]..token.span[1]];
        let next = tokens.get(at + 1).map_or("", |next| next.word.as_str());
        // In "turn right before the stairs" the word "right" means the side after all.
        let is_turn = at > 0 && matches!(tokens[at - 1].word.as_str(), "turn" | "go" | "the" | "a" | "your");
        let is_just = token.word == "right" && WORDS_AFTER_JUST.contains(&next) && !is_turn;
        swapped.push_str(&text[from..token.span[0]]);
        swapped.push_str(&if is_just { word.to_owned() } else { other_side(word) });
        from = token.span[1];
    }
    swapped.push_str(&text[from..]);
    swapped
}

/// The word for the other side, in the same case; other words are returned unchanged.
fn other_side(word: &str) -> String {
    for (one, other) in [("left", "right"), ("right", "left"), ("Left", "Right"), ("Right", "Left")] {
        if let Some(rest) = word.strip_prefix(one).filter(|rest| SIDE_WORD_ENDINGS.contains(rest)) {
            return format!("{other}{rest}");
        }
    }
    word.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> AnnotatedText<'_> {
        AnnotatedText { text, mentions: &[], last_frame: 0 }
    }

    #[test]
    fn check_mirrored_world_expects_the_other_side_in_the_same_case() {
        let base =
            of("Turn left. Right of the leftmost bed, take the right-hand door and stop right next to the lamp.");
        let mirrored =
            of("Turn right. Left of the rightmost bed, take the left-hand door and stop right next to the lamp.");
        assert_eq!(check_mirrored_world(base, mirrored), ExpectationOutcome::Holds);
        assert_eq!(check_mirrored_world(mirrored, base), ExpectationOutcome::Holds);
        assert!(
            matches!(check_mirrored_world(base, base), ExpectationOutcome::Differs(why) if why.contains("Turn right."))
        );
        assert_eq!(
            check_mirrored_world(of("Turn right before the stairs."), of("Turn left before the stairs.")),
            ExpectationOutcome::Holds
        );
    }

    #[test]
    fn a_text_without_sides_stays_in_a_mirrored_world() {
        assert_eq!(check_mirrored_world(of("Stop by the bed."), of("Stop by the bed.")), ExpectationOutcome::Holds);
    }

    #[test]
    fn in_a_turned_world_not_a_byte_changes() {
        assert_eq!(check_turned_world(of("Turn left."), of("Turn left.")), ExpectationOutcome::Holds);
        assert!(matches!(check_turned_world(of("Turn left."), of("Turn left")), ExpectationOutcome::Differs(_)));
    }
}

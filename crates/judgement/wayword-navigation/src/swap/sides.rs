//! Swaps left and right, and up and down.
//!
//! Whether a word is swapped depends only on the words around it, and not on which word of its pair it is. So a text that is swapped
//! twice is the same as before. Words that mean no direction stay, as "right" in "right before the sofa".

use super::casing::{LetterCase, replace_spans};
use std::collections::BTreeSet;
use wayword_core::Side;
use wayword_language::{
    directions::{AFTER_SIDE, BEFORE_SIDE, BEFORE_STAIRS, GOING},
    reading::{EventContent, read_instruction},
    text::{TextToken, split_tokens},
};

/// Words that name a direction, each with its opposite.
const SIDE_PAIRS: [[&str; 2]; 3] = [["left", "right"], ["leftward", "rightward"], ["leftwards", "rightwards"]];
/// Words for up and down, each with its opposite.
const LEVEL_PAIRS: [[&str; 2]; 5] =
    [["up", "down"], ["upstairs", "downstairs"], ["ascend", "descend"], ["ascending", "descending"], ["top", "bottom"]];

/// The text with its directions swapped; `None` where it names none.
pub(super) fn swap_directions(text: &str) -> Option<String> {
    let text_tokens = TextTokens { text, tokens: split_tokens(text) };
    let mut edits: Vec<([usize; 2], String)> = Vec::new();
    let turns = text_tokens.turn_tokens();
    for at in 0..text_tokens.tokens.len() {
        if let Some(opposite) = text_tokens.opposite_at(at, &turns) {
            edits.extend(text_tokens.edits_at(at, opposite));
        }
    }
    (!edits.is_empty()).then(|| replace_spans(text, &edits))
}

/// A text with its tokens. The methods find tokens by their index.
struct TextTokens<'a> {
    text: &'a str,
    tokens: Vec<TextToken>,
}

impl<'a> TextTokens<'a> {
    /// The word of a token in lower case; empty behind the last token.
    fn word_at(&self, at: usize) -> &str {
        self.tokens.get(at).map_or("", |token| token.word.as_str())
    }

    /// The word of the token that is `back` tokens before `at`; empty before the first token.
    fn word_before(&self, at: usize, back: usize) -> &str {
        at.checked_sub(back).map_or("", |at| self.word_at(at))
    }

    /// A token as the text writes it, in its letter case.
    fn written_at(&self, at: usize) -> &'a str {
        let [from, to] = self.tokens[at].span;
        &self.text[from..to]
    }

    /// The tokens of sides that are turns. The reader sees a turn in "left past the sofa" but not in "right past the sofa". To
    /// treat both words alike, this reads the text with the same word of each pair everywhere.
    fn turn_tokens(&self) -> BTreeSet<usize> {
        let one_of_pair = |at: usize| match self.word_at(at) {
            word if other_of_pair(&SIDE_PAIRS, word).is_some() => Some("right"),
            word => LEVEL_PAIRS.iter().find(|pair| pair.contains(&word)).map(|[one, _]| *one).or_else(|| {
                self.opposite_course(at).map(|_| if matches!(word, "turn" | "go") { "turn" } else { "around" })
            }),
        };
        let edit = |at: usize| Some((self.tokens[at].span, one_of_pair(at)?.to_owned()));
        let same = replace_spans(self.text, &(0..self.tokens.len()).filter_map(edit).collect::<Vec<_>>());
        let reading = read_instruction(&same, &BTreeSet::new());
        let first_token = |from: usize| reading.tokens().partition_point(|token| token.span[0] < from);
        let turns = reading.events.iter().filter(|event| event.what == EventContent::Turn(Side::Right));
        turns.map(|event| first_token(event.span[0])).collect()
    }

    /// The opposite of the word at a token, if the word means a direction there.
    fn opposite_at(&self, at: usize, turns: &BTreeSet<usize>) -> Option<&'static str> {
        let word = self.word_at(at);
        if let Some(other) = other_of_pair(&SIDE_PAIRS, word) {
            return (turns.contains(&at) || self.locates_place(at)).then_some(other);
        }
        if let Some(other) = other_of_pair(&LEVEL_PAIRS, word) {
            let is_level = match word {
                "up" | "down" => self.is_climb(at),
                "top" | "bottom" if self.word_at(at + 1) == "of" => self.leads_to_stairs(at + 2),
                "top" | "bottom" => (1..=4).any(|back| is_stairs(self.word_before(at, back))),
                _ => true,
            };
            return is_level.then_some(other);
        }
        self.opposite_course(at)
    }

    /// The word to write at a token in order to swap "turn around" and "go straight", where these two words are a whole clause.
    fn opposite_course(&self, at: usize) -> Option<&'static str> {
        let is_clause = |from: usize| {
            let begins = from == 0 || self.separates_clauses(from - 1);
            begins && (from + 2 >= self.tokens.len() || self.separates_clauses(from + 2))
        };
        match (self.word_before(at, 1), self.word_at(at), self.word_at(at + 1)) {
            (_, "turn", "around") if is_clause(at) => Some("go"),
            (_, "go", "straight") if is_clause(at) => Some("turn"),
            ("turn", "around", _) if is_clause(at - 1) => Some("straight"),
            ("go", "straight", _) if is_clause(at - 1) => Some("around"),
            _ => None,
        }
    }

    /// Whether a token separates two clauses: a mark, "and" or "then".
    fn separates_clauses(&self, at: usize) -> bool {
        !self.tokens[at].is_word() || matches!(self.word_at(at), "and" | "then")
    }

    /// Whether the word for a side gives a place: "on the left", "to the left of the sofa", "the left door", "left and right", but
    /// not "right before the sofa".
    fn locates_place(&self, at: usize) -> bool {
        let is_side = |word: &str| other_of_pair(&SIDE_PAIRS, word).is_some();
        let listed = matches!(self.word_before(at, 1), "and" | "or") && is_side(self.word_before(at, 2)) && at > 2;
        BEFORE_SIDE.contains(&self.word_before(at, 1))
            || (self.word_before(at, 1) == "to" && !self.word_at(at + 1).starts_with("the"))
            || AFTER_SIDE.contains(&self.word_at(at + 1))
            || (listed && self.locates_place(at - 2))
    }

    /// Whether "up" or "down" means a climb: "up the stairs", "up to the second floor", "the stairs up", "go up.", but not "down the
    /// hallway".
    fn is_climb(&self, at: usize) -> bool {
        let behind_stairs = (1..=3).any(|back| is_stairs(self.word_before(at, back)));
        let ends = at + 1 >= self.tokens.len() || self.separates_clauses(at + 1);
        let to_floor = self.word_at(at + 1) == "to" && self.leads_to(at + 2, is_floor);
        self.leads_to_stairs(at + 1)
            || to_floor
            || (behind_stairs && !matches!(self.word_at(at + 1), "the" | "a" | "an"))
            || (ends && GOING.contains(&self.word_before(at, 1)))
    }

    /// Whether the noun phrase that begins at a token ends in stairs or a floor.
    fn leads_to_stairs(&self, from: usize) -> bool {
        self.leads_to(from, |word| is_stairs(word) || is_floor(word))
    }

    /// Whether the noun phrase that begins at a token ends in a word for which `is_end` is true, within six words.
    fn leads_to(&self, from: usize, is_end: impl Fn(&str) -> bool) -> bool {
        let skips = |word: &str| BEFORE_STAIRS.contains(&word) || word.bytes().all(|byte| byte.is_ascii_digit());
        let end = (from..from + 6).find(|at| is_end(self.word_at(*at)) || !skips(self.word_at(*at)));
        end.is_some_and(|at| is_end(self.word_at(at)))
    }

    /// The edits that write another word at a token, in its letter case and with its article. Empty if a second swap could not
    /// restore the spelling, as in "lEft".
    fn edits_at(&self, at: usize, word: &str) -> Vec<([usize; 2], String)> {
        let written = self.written_at(at);
        let case = LetterCase::for_text(written);
        if case.apply_to(self.word_at(at)) != written {
            return Vec::new();
        }
        let edit = (self.tokens[at].span, case.apply_to(word));
        let before = at.checked_sub(1).filter(|before| matches!(self.word_at(*before), "a" | "an"));
        // Of the words that are swapped, only these need a different article: "an upstairs room", "a downstairs room".
        let Some(before) = before.filter(|_| matches!(word, "upstairs" | "downstairs")) else { return vec![edit] };
        let pair = match (self.written_at(before), case) {
            ("a" | "an", LetterCase::Lower | LetterCase::Title) => ["an", "a"],
            ("A" | "An", LetterCase::Lower | LetterCase::Title) => ["An", "A"],
            ("A" | "AN", LetterCase::Upper) => ["AN", "A"],
            _ => return Vec::new(),
        };
        let [old, new] = if word == "upstairs" { [pair[1], pair[0]] } else { pair };
        if self.written_at(before) == old { vec![(self.tokens[before].span, new.to_owned()), edit] } else { Vec::new() }
    }
}

/// The other word of a pair.
fn other_of_pair(pairs: &[[&'static str; 2]], word: &str) -> Option<&'static str> {
    pairs.iter().find_map(|[a, b]| match word {
        word if word == *a => Some(*b),
        word if word == *b => Some(*a),
        _ => None,
    })
}

fn is_stairs(word: &str) -> bool {
    matches!(
        word,
        "stairs" | "stair" | "staircase" | "staircases" | "steps" | "stairway" | "flights" | "stairwell" | "landing"
    )
}

fn is_floor(word: &str) -> bool {
    matches!(word, "floor" | "floors" | "level" | "levels" | "story" | "storey" | "flight")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn directions_are_swapped_both_ways() {
        for (text, wanted) in [
            ("Turn left at the sofa.", "Turn right at the sofa."),
            ("TAKE A RIGHT, then bear left.", "TAKE A LEFT, then bear right."),
            ("Clean the lamp on your left", "Clean the lamp on your right"),
            ("Wait to the left of the bed.", "Wait to the right of the bed."),
            ("Open the right drawer on the far left", "Open the left drawer on the far right"),
            (
                "Go up the stairs. Wait at the top of the stairs.",
                "Go down the stairs. Wait at the bottom of the stairs.",
            ),
            ("Take the stairs down to the hall", "Take the stairs up to the hall"),
            ("Climb up the two steps", "Climb down the two steps"),
            ("Go upstairs to an upstairs bathroom", "Go downstairs to a downstairs bathroom"),
            ("Turn around and walk on, then go straight.", "Go straight and walk on, then turn around."),
            ("Doors are on your left and right", "Doors are on your right and left"),
            ("Go up to the second floor", "Go down to the second floor"),
            ("Go down and wait", "Go up and wait"),
            ("Enter the hall to the slight right past the sofa", "Enter the hall to the slight left past the sofa"),
            ("Walk down the steps to the bottom.", "Walk up the steps to the top."),
        ] {
            assert_eq!(swap_directions(text).as_deref(), Some(wanted));
            assert_eq!(swap_directions(wanted).as_deref(), Some(text));
        }
    }

    #[test]
    fn words_that_mean_no_direction_stay() {
        for text in [
            "Stop right before the bed",
            "Walk right past the sofa",
            "All right, wait",
            "Wait in the room you left before",
            "Walk down the hallway",
            "Walk up to the table",
            "Pick up the pillow and wipe down the sink",
            "Clean the picture at the top of the bed",
            "Go straight down the hallway",
        ] {
            assert_eq!(swap_directions(text), None, "{text}");
        }
    }

    /// The article changes with the word behind it, and must not decide whether the word before it is swapped.
    #[test]
    fn either_article_behind_stairs_keeps_the_word_before_it() {
        for text in ["stairs up an Upstairs", "stairs up a Downstairs"] {
            let once = swap_directions(text).unwrap();
            assert!(once.starts_with("stairs up") && swap_directions(&once).unwrap() == text, "{once}");
        }
    }

    proptest! {
        #[test]
        fn swapping_twice_restores_the_text(text in "((left|Left|LEFT|lEft|right|RIGHT|Right|up|down|Upstairs|upstairs|downstairs|a|A|AN|an|An|the|turn|Turn|go|take|around|straight|stairs|floor|of|to|top|bottom|and|then|on|your|past|sofa|wall|side|ß|[,.'’-])  ?){0,25}|\\PC{0,60}") {
            if let Some(once) = swap_directions(&text) {
                prop_assert_eq!(swap_directions(&once), Some(text));
            }
        }
    }
}

//! Finds the turns of a text. "Left" is a turn in "go left", but not in "the left door", so the words around a side
//! decide.

mod clock;
mod repeated_turns;
#[cfg(test)]
mod tests;

use super::{EventContent, TextEvent, tokens::TokenSlice, vocabulary as v};
use crate::{
    lexicon::{is_room, is_thing, normal_word},
    text::TextToken,
};
use wayword_core::Side;

/// The turns of a text.
pub(super) fn read_turns(tokens: TokenSlice<'_>, clauses: &[usize]) -> Vec<TextEvent> {
    let text = TurnText::from_tokens(tokens);
    let mut turns: Vec<TextEvent> = Vec::new();
    let mut has_turn_in_sentence = false;
    let mut turn_around_verb = None;
    for (at, clause) in clauses.iter().enumerate() {
        if tokens.get(at).is_some_and(TextToken::ends_sentence) {
            (has_turn_in_sentence, turn_around_verb) = (false, None);
        }
        let turn = match text.turn_around_at(at) {
            Some(about) => Some((Side::Behind, about.verb, about.last)),
            None => text
                .turn_side_at(at, has_turn_in_sentence)
                .map(|(side, verb)| (side, verb, at))
                .or_else(|| clock::clock_turn(tokens, text.before_side_of_turn[at], at)),
        };
        let Some((side, verb, last)) = turn else { continue };
        // "Turn 180 degrees to the right" is one turn.
        if verb.is_some() && verb == turn_around_verb {
            continue;
        }
        if side == Side::Behind {
            turn_around_verb = verb;
        }
        has_turn_in_sentence = true;
        let event = |first, last| TextEvent {
            what: EventContent::Turn(side),
            span: tokens.span_of(first, last),
            clause: *clause,
            denied: false,
        };
        turns.push(event(at, last));
        let (more, (number_first, number_last)) = repeated_turns::more_turns(tokens, at, last);
        turns.extend((0..more).map(|_| event(number_first, number_last)));
    }
    turns
}

/// The side that a word names, whether or not it is a turn.
fn side_word(word: &str) -> Option<Side> {
    match word {
        "left" | "leftward" | "leftwards" | "lefts" => Some(Side::Left),
        "right" | "rightward" | "rightwards" | "rights" => Some(Side::Right),
        _ => None,
    }
}

/// A turn around: its verb, where it has one, and its last token.
struct TurnAround {
    verb: Option<usize>,
    last: usize,
}

/// A text, and for each of its tokens the start of the run of words before it that may come between a verb and a turn.
struct TurnText<'a> {
    tokens: TokenSlice<'a>,
    /// For a turn around: "turn all the way around".
    before_about: Vec<usize>,
    /// For a side behind any verb: "go to your left".
    before_side: Vec<usize>,
    /// For a side behind a verb of turning, with more words between: "take the second left".
    before_side_of_turn: Vec<usize>,
}

impl<'a> TurnText<'a> {
    fn from_tokens(tokens: TokenSlice<'a>) -> Self {
        let is_number = |word: &str| word.chars().all(|c| c.is_ascii_digit() || c == '.');
        let can_follow_turning =
            |word: &str| v::BEFORE_SIDE.contains(&word) || v::BEFORE_SIDE_OF_TURN.contains(&word) || is_number(word);
        Self {
            tokens,
            before_about: tokens.runs_before(|word| v::BEFORE_ABOUT.contains(&word)),
            before_side: tokens.runs_before(|word| v::BEFORE_SIDE.contains(&word)),
            before_side_of_turn: tokens.runs_before(can_follow_turning),
        }
    }

    fn word_at(&self, at: usize) -> &'a str {
        self.tokens.word_at(at)
    }

    fn word_before(&self, at: usize) -> &'a str {
        self.tokens.word_before(at)
    }

    /// The turn around that begins at a token.
    fn turn_around_at(&self, at: usize) -> Option<TurnAround> {
        let next = self.word_at(at + 1);
        let verb = || {
            let verb =
                self.before_about[at].checked_sub(1).filter(|verb| v::SPINNING.contains(&self.word_at(*verb)))?;
            Some(TurnAround { verb: Some(verb), last: at })
        };
        let by_itself = |last: usize| Some(TurnAround { verb: None, last });
        match self.word_at(at) {
            "u" if next == "turn" => by_itself(at + 1),
            "uturn" => by_itself(at),
            "face" if at > 0 && self.word_at(at - 1) == "about" => by_itself(at),
            // "Turn around the corner" does not mean to turn around.
            "around" if !matches!(next, "the" | "a" | "an" | "this" | "that") => verb(),
            "180" => {
                let is_noun = [next, self.word_at(at + 2)].contains(&"turn");
                let done = at > 1 && self.word_at(at - 1) == "a" && v::DOING.contains(&self.word_at(at - 2));
                if is_noun || done { by_itself(at) } else { verb() }
            }
            "back" if !matches!(next, "around" | "180" | "on" | "off" | "left" | "right") => {
                verb().filter(|about| about.verb == at.checked_sub(1))
            }
            "opposite" | "other" if matches!(next, "direction" | "way") => verb(),
            "reverse" if matches!(next, "direction" | "course" | "directions") => by_itself(at),
            "about" if next == "turn" => by_itself(at + 1),
            "one" if next == "eighty" && matches!(self.word_before(at), "a" | "turn" | "rotate" | "spin") => {
                by_itself(at + 1)
            }
            _ => None,
        }
    }

    /// The side of the turn that a token means, and its verb, where it has one.
    fn turn_side_at(&self, at: usize, has_earlier_turn: bool) -> Option<(Side, Option<usize>)> {
        let side = side_word(self.word_at(at))?;
        let after = self.word_at(at + 1);
        let is_counted = repeated_turns::is_count(self.word_before(at));
        let is_turn = |word: &str| word == "turn" || (word == "turns" && is_counted);
        if is_turn(after) || (after == "hand" && is_turn(self.word_at(at + 2))) {
            return Some((side, None));
        }
        if matches!(self.word_at(at), "lefts" | "rights") {
            return is_counted.then_some((side, None));
        }
        // The starts of the runs of words that may come between a verb and the side.
        let (from, far) = (self.before_side[at], self.before_side_of_turn[at]);
        let turning = far.checked_sub(1).filter(|verb| self.is_turning(*verb, far..at));
        if self.tells_a_place(at, turning) || (side == Side::Right && self.is_adverb(at, turning, has_earlier_turn)) {
            return None;
        }
        let is_turn = turning.is_some()
            || self.goes_there(from, at)
            || self.stands_alone(from, at, has_earlier_turn)
            || self.follows_a_way(at);
        is_turn.then_some((side, turning))
    }

    /// Whether the word at `verb` is a verb of turning, with these words between it and the side.
    fn is_turning(&self, verb: usize, mut between: std::ops::Range<usize>) -> bool {
        let word = self.word_at(verb);
        v::TURNING.contains(&word)
            || (matches!(word, "round" | "rounding") && between.any(|at| self.word_at(at) == "corner"))
    }

    /// Whether the side distinguishes or locates a thing: "the left wall", "left of the sofa".
    fn tells_a_place(&self, at: usize, turning: Option<usize>) -> bool {
        let after = self.word_at(at + 1);
        if matches!(after, "of" | "side" | "hand" | "wall" | "corner" | "most") {
            return true;
        }
        // "Turn left hallway" lacks a comma; "take left doorway" lacks an article.
        let directly = |verb: usize| verb + 1 == at && !v::DOING.contains(&self.word_at(verb));
        if turning.is_some_and(directly) {
            return false;
        }
        let is_noun = |word: &str| {
            let name = normal_word(word);
            is_thing(&name) || is_room(&name) || v::HAVE_SIDES.contains(&word)
        };
        let of_a_noun = is_noun(after) || (v::ADJECTIVES.contains(&after) && is_noun(self.word_at(at + 2)));
        let definite = at > 0 && matches!(self.word_at(at - 1), "the" | "your" | "that" | "far");
        let unknown_noun = definite
            && self.tokens.is_word(at + 1)
            && !v::BREAKERS.contains(&after)
            && !v::ADVERBS.contains(&after)
            && !matches!(after, "again" | "here" | "during" | "following" | "entering");
        of_a_noun || unknown_noun
    }

    /// Whether "right" is an adverb and no side: "right before the sofa", "walk right up to the table".
    fn is_adverb(&self, at: usize, turning: Option<usize>, has_earlier_turn: bool) -> bool {
        let after = self.word_at(at + 1);
        let before = self.tokens.word_before(at);
        // In "left, then right past the sofa" a second turn follows; in "stop, then right after the sofa" none does.
        let directly = !v::BEFORE_SIDE.contains(&before) || (matches!(before, "and" | "then") && !has_earlier_turn);
        matches!(after, "away" | "now")
            || (after == "around" && turning.is_some())
            || (turning.is_none() && directly && v::AFTER_ADVERB_RIGHT.contains(&after))
    }

    /// Whether the walk goes to the side: "go left", "head to your right". The words between the verb of going and the side
    /// begin at `from`.
    fn goes_there(&self, from: usize, at: usize) -> bool {
        let verb = from.checked_sub(1).map_or("", |verb| self.word_at(verb));
        let mut skipped = (from..at).map(|at| self.word_at(at));
        // "Make your way left".
        let is_way = verb == "way" && from > 2 && self.word_at(from - 2) == "your" && {
            matches!(self.word_at(from - 3), "make" | "making" | "work" | "find" | "wind" | "continue")
        };
        // "Move right the shower curtain": something is moved, and nobody walks.
        let moves_thing = verb == "move" && v::DETERMINERS.contains(&self.word_at(at + 1));
        !moves_thing
            && (v::GOING.contains(&verb) || is_way)
            && (skipped.clone().any(|word| word == "to")
                || skipped.all(|word| matches!(word, "immediately" | "slightly" | "slight" | "then" | "back")))
    }

    /// Whether the side is a clause by itself: ", then left", "and left.", "Left at the sofa".
    fn stands_alone(&self, from: usize, at: usize, has_earlier_turn: bool) -> bool {
        let skipped: Vec<&str> = (from..at).map(|at| self.word_at(at)).collect();
        let joined = skipped.iter().any(|word| matches!(*word, "and" | "then" | "but"));
        let again = skipped.iter().any(|word| matches!(*word, "another" | "again"));
        let begins = from == 0 || !self.tokens.is_word(from - 1);
        let to = skipped.contains(&"to");
        let ends = self.tokens.get(at + 1).is_none_or(|token| !token.is_word() && token.word != ")")
            || v::AFTER_SIDE.contains(&self.word_at(at + 1));
        // "On your left and right": not a turn where the side before was not one.
        let lists_sides = joined && !has_earlier_turn && from > 0 && side_word(self.word_at(from - 1)).is_some();
        if lists_sides {
            return false;
        }
        has_earlier_turn && (again || (joined && !to) || (begins && !to)) || (ends && (joined || (begins && !to)))
    }

    /// Whether the side follows a way that is taken: "take the hallway left".
    fn follows_a_way(&self, at: usize) -> bool {
        let ends = self.tokens.get(at + 1).is_none_or(|token| !token.is_word())
            || v::AFTER_SIDE.contains(&self.word_at(at + 1));
        let Some(noun) = at.checked_sub(1).filter(|_| ends) else { return false };
        let name = normal_word(self.word_at(noun));
        let verb = (noun.saturating_sub(4)..noun).rev().find(|before| v::DETERMINERS.contains(&self.word_at(*before)));
        let taken = verb.and_then(|article| article.checked_sub(1)).map_or("", |verb| self.word_at(verb));
        (is_thing(&name) || is_room(&name) || matches!(self.word_at(noun), "path" | "way" | "passage"))
            && matches!(taken, "take" | "taking" | "follow" | "following" | "use")
    }
}

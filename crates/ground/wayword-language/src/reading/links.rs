//! Finds how the words before a place link it to its sentence: as a goal, as a place that one is in, or as one that is
//! only nearby.

use super::{PlaceLink, tokens::TokenSlice, vocabulary as v};
use crate::lexicon::{is_room, normal_word};

/// How far before a place its preposition may be, words.
const LINK_REACH_WORDS: usize = 7;

/// How the place that begins at a token is linked to its sentence.
pub(super) fn link_before(tokens: TokenSlice<'_>, clauses: &[usize], from: usize) -> PlaceLink {
    // Read backwards, up to the beginning of the clause.
    let clause = clauses[from.min(clauses.len() - 1)];
    let in_clause = (0..from).rev().take_while(|at| tokens.is_word(*at) && clauses[*at] == clause);
    let words: Vec<&str> = in_clause.take(LINK_REACH_WORDS).map(|at| tokens.word_at(at)).collect();
    let is_link = |word: &&str| {
        let breaks = v::BREAKERS.contains(word) && !v::DETERMINERS.contains(word);
        (breaks || v::BESIDE.contains(word)) && !matches!(*word, "and" | "or")
    };
    let Some(at) = words.iter().position(is_link) else {
        return if words.iter().any(|word| v::ARRIVING.contains(word)) { PlaceLink::Goal } else { PlaceLink::Plain };
    };
    let before = words.get(at + 1).copied().unwrap_or("");
    let has_across = || words[at + 1..].iter().take(3).any(|word| *word == "across");
    match words[at] {
        // "next to" and "closest to", but not "walk to".
        "to" if v::BESIDE.contains(&before) => PlaceLink::Beside,
        "to" | "into" | "onto" | "toward" | "towards" | "until" | "till" => PlaceLink::Goal,
        "from" if has_across() => PlaceLink::Beside,
        // "The end of the hallway" is in it, but "the door of the kitchen" may be seen from outside.
        "of" if !matches!(before, "out" | "inside" | "end" | "middle" | "center" | "centre" | "top" | "bottom") => {
            PlaceLink::Beside
        }
        // "The bathroom in the hallway" is next to it, "the bedroom across the hallway" is beyond it.
        "in" | "at" | "on" | "across" if is_room(&normal_word(before)) => PlaceLink::Beside,
        "in" | "inside" | "within" | "at" | "on" | "upon" | "from" | "of" | "that" | "which" => PlaceLink::Within,
        "past" | "through" | "down" | "along" | "across" | "up" | "around" | "after" => PlaceLink::Along,
        word if v::BESIDE.contains(&word) => PlaceLink::Beside,
        _ => PlaceLink::Plain,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::{EventContent, read_instruction};
    use std::collections::BTreeSet;

    fn last(text: &str) -> PlaceLink {
        match read_instruction(text, &BTreeSet::new()).events.last().map(|event| event.what.clone()) {
            Some(EventContent::Place(place)) => place.link,
            other => panic!("{text}: {other:?}"),
        }
    }

    #[test]
    fn only_words_of_nearness_leave_a_place_aside() {
        for text in [
            "stop next to the kitchen",
            "the closet off the bedroom",
            "the door across the hall from the kitchen",
            "wait to the left of the kitchen",
            "go to the bathroom near the living room and bedroom",
            "the stairs leading to the kitchen",
            "the bedroom with the bathroom",
            "the bathroom in the hallway",
            "the bedroom across the hallway",
            "touch the door of the kitchen",
        ] {
            assert_eq!(last(text), PlaceLink::Beside, "{text}");
        }
        for text in [
            "stop in the kitchen",
            "start at the kitchen",
            "walk out of the kitchen",
            "wait at the end of the hallway",
            "coming from the kitchen",
        ] {
            assert_eq!(last(text), PlaceLink::Within, "{text}");
        }
    }

    #[test]
    fn link_separates_a_goal_from_the_way_there() {
        for text in ["walk to the kitchen", "enter the kitchen", "turn left into the kitchen"] {
            assert_eq!(last(text), PlaceLink::Goal, "{text}");
        }
        for text in ["walk to the bathroom past the kitchen", "go down the hallway", "walk across the kitchen"] {
            assert_eq!(last(text), PlaceLink::Along, "{text}");
        }
        assert_eq!(last("leave the kitchen"), PlaceLink::Plain);
    }
}

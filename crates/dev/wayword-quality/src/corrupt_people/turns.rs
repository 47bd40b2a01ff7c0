//! Finds the turns and climbs that a text commands, and flips them: left to right, up to down.

use super::{
    lists::{MOTION_WORDS, has_word},
    text::PlainWord,
};
use crate::key::WordEdit;

/// Most words between a verb and its side.
const MAX_WORDS_BEFORE_SIDE: usize = 4;

/// An edit for every turn of a text that flips its side. A side of a thing ("the door on the left") is no turn.
pub(super) fn flipped_turns(text: &str, words: &[PlainWord]) -> Vec<WordEdit> {
    let sides = words.iter().enumerate().filter(|(at, _)| is_turn(words, *at));
    sides.filter_map(|(_, word)| flip_word(text, word, &[("left", "right")])).collect()
}

/// Whether the word at `at` is the side of a turn, by the verb before it and the word behind it.
fn is_turn(words: &[PlainWord], at: usize) -> bool {
    let word = &words[at];
    if !matches!(word.low.as_str(), "left" | "right") {
        return false;
    }
    let next = words.get(at + 1).filter(|next| next.is_joined).map(|next| next.low.as_str());
    let may_follow = |list: &str| next.is_none_or(|next| has_word(&MOTION_WORDS, list, next));
    let verb = word_before(words, at, "between", MAX_WORDS_BEFORE_SIDE);
    let verb_is_in = |list: &str| verb.is_some_and(|verb| has_word(&MOTION_WORDS, list, verb));
    // "Left at the sofa."
    let is_bare = || starts_clause(words, at) && next.is_some_and(|next| has_word(&MOTION_WORDS, "after turn", next));
    let turns = verb_is_in("turn verbs") || verb_is_in("take verbs");
    turns && may_follow("after turn") || verb_is_in("walk verbs") && may_follow("after walk") || is_bare()
}

/// The nearest word before `at` that is not in `list`, at most `most` words of the list further back. A mark ends the search.
fn word_before<'w>(words: &'w [PlainWord], at: usize, list: &str, most: usize) -> Option<&'w str> {
    let mut at = at;
    for _ in 0..=most {
        let previous = words.get(at.checked_sub(1)?).filter(|_| words[at].is_joined)?;
        at -= 1;
        if !has_word(&MOTION_WORDS, list, &previous.low) {
            return Some(&previous.low);
        }
    }
    None
}

fn starts_clause(words: &[PlainWord], at: usize) -> bool {
    !words[at].is_joined || matches!(words[at - 1].low.as_str(), "then" | "and")
}

/// An edit for every climb of a text that flips its direction. "The stairs leading down" is no climb.
pub(super) fn flipped_climbs(text: &str, words: &[PlainWord]) -> Vec<WordEdit> {
    let climbing = words.iter().enumerate().filter(|(at, _)| is_climb(words, *at)).map(|(_, word)| word);
    let pairs = [
        ("up", "down"),
        ("upstairs", "downstairs"),
        ("ascend", "descend"),
        ("ascending", "descending"),
        ("climb", "descend"),
    ];
    climbing.filter_map(|word| flip_word(text, word, &pairs)).collect()
}

/// Whether the word at `at` is the direction of a climb, by the verb before it and the stairs around it.
fn is_climb(words: &[PlainWord], at: usize) -> bool {
    let is_verb = |before: Option<&str>| before.is_some_and(|word| has_word(&MOTION_WORDS, "climb verbs", word));
    match words[at].low.as_str() {
        "up" | "down" => {
            let leads = is_verb(word_before(words, at, "climb adverbs", 3)) && stairs_after(words, at);
            // "Take the stairs up."
            let joined = |at: usize| words.get(at).filter(|word| word.is_joined);
            let ends = at >= 1
                && joined(at).is_some()
                && has_word(&MOTION_WORDS, "stairs", &words[at - 1].low)
                && word_before(words, at - 1, "before stairs", 3)
                    .is_some_and(|word| has_word(&MOTION_WORDS, "use verbs", word));
            leads || ends
        }
        "upstairs" | "downstairs" => is_verb(word_before(words, at, "climb adverbs", 3)),
        "ascend" | "descend" | "ascending" | "descending" | "climb" => stairs_after(words, at),
        _ => false,
    }
}

/// Whether stairs follow, with only words before them that describe stairs.
fn stairs_after(words: &[PlainWord], at: usize) -> bool {
    let joined = words[at + 1..].iter().take_while(|word| word.is_joined);
    let mut rest = joined.skip_while(|word| has_word(&MOTION_WORDS, "before stairs", &word.low));
    rest.next().is_some_and(|word| has_word(&MOTION_WORDS, "stairs", &word.low))
}

/// The edit that replaces a word by the other one of its pair, with the same capitals.
fn flip_word(text: &str, word: &PlainWord, pairs: &[(&str, &str)]) -> Option<WordEdit> {
    let other = pairs.iter().find_map(|(a, b)| match word.low.as_str() {
        low if low == *a => Some(*b),
        low if low == *b => Some(*a),
        _ => None,
    })?;
    let was = text.get(word.span[0]..word.span[1])?;
    let is_upper = |c: char| c.is_uppercase();
    let now = if was.chars().all(is_upper) {
        other.to_uppercase()
    } else if was.starts_with(is_upper) {
        format!("{}{}", other[..1].to_uppercase(), &other[1..])
    } else {
        other.to_owned()
    };
    Some(WordEdit { span: word.span, now })
}

#[cfg(test)]
mod tests {
    use super::{super::text::split_words, *};

    fn flips(find: fn(&str, &[PlainWord]) -> Vec<WordEdit>, text: &str) -> Vec<String> {
        let edits = find(text, &split_words(text));
        edits
            .into_iter()
            .map(|edit| format!("{}{}{}", &text[..edit.span[0]], edit.now, &text[edit.span[1]..]))
            .collect()
    }

    #[test]
    fn a_turn_is_flipped_where_a_text_commands_one() {
        for (text, expected) in [
            ("Turn left.", "Turn right."),
            ("Then make a sharp right at the sofa", "Then make a sharp left at the sofa"),
            ("take the first left into the hall", "take the first right into the hall"),
            ("Go left and wait", "Go right and wait"),
            ("turn to your right", "turn to your left"),
            ("Left at the sofa.", "Right at the sofa."),
            ("TURN RIGHT", "TURN LEFT"),
            ("make a left turn", "make a right turn"),
        ] {
            assert_eq!(flips(flipped_turns, text), [expected]);
        }
    }

    #[test]
    fn the_side_of_a_thing_is_no_turn() {
        for text in [
            "Enter the door on the left.",
            "Take the left door.",
            "Turn at the right side of the sofa",
            "turn to the left of the sofa",
            "Go right past the table",
            "walk right up to it",
            "Stop right there",
            "Pass the sofa on your right and stop",
        ] {
            assert!(flips(flipped_turns, text).is_empty(), "{text}");
        }
    }

    #[test]
    fn climbs_are_flipped_but_not_stairs_that_only_lead_up_or_down() {
        for (text, expected) in [
            ("Walk up the stairs.", "Walk down the stairs."),
            ("go back down the short flight of steps", "go back up the short flight of steps"),
            ("Go upstairs", "Go downstairs"),
            ("Climb the stairs", "Descend the stairs"),
            ("take the stairs down to the hall", "take the stairs up to the hall"),
            ("Descend the wooden staircase", "Ascend the wooden staircase"),
        ] {
            assert_eq!(flips(flipped_climbs, text), [expected]);
        }
        for text in ["Walk down the hall", "Pass the stairs leading down", "walk up to the stairs", "the room upstairs"]
        {
            assert!(flips(flipped_climbs, text).is_empty(), "{text}");
        }
    }
}

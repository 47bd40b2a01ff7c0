//! Finds the landmarks and rooms of a text, with their side, colour, number, and how the walk goes by them.

use super::{
    EventContent, PlaceMention, TextEvent, colours::PlaceColours, distances::is_unit, links::link_before,
    numbers::PlaceNumbers, place_motion::motion_by_place, sides, task, tokens::TokenSlice, vocabulary as v,
};
use crate::lexicon::{ThingClass, find_thing, is_room, is_thing, longest_name, means_several, normal_word, room_name};
use std::collections::BTreeSet;

/// A run of tokens that names a place.
struct PlaceCandidate {
    /// Where the words begin that distinguish it: "bedroom" of "the second bedroom door".
    noun: usize,
    /// The first token of its name.
    from: usize,
    /// The token behind its name.
    to: usize,
    /// Its name in normal spelling.
    name: String,
    /// Whether the name can be an object's.
    is_thing: bool,
    /// Whether the name can be a room's.
    is_room: bool,
}

/// The places of a text. Tokens within `taken` spans are skipped; sides and numbers within `others` belong to
/// turns and storeys.
pub(super) fn read_places(
    tokens: TokenSlice<'_>,
    clauses: &[usize],
    known: &BTreeSet<String>,
    taken: &[[usize; 2]],
    others: &[[usize; 2]],
) -> Vec<TextEvent> {
    let free = free_tokens(tokens, taken);
    let mut candidates: Vec<PlaceCandidate> = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let next = if free[at] {
            named_place_at(tokens, at, known)
                .or_else(|| unnamed_place_at(tokens, at, known).filter(|place| is_free_of(others, tokens, place)))
        } else {
            None
        };
        at = next.as_ref().map_or(at + 1, |place| place.to);
        let Some(mut place) = next else { continue };
        // "The kitchen table": a place right before another only qualifies the other. A basement does not,
        // because it is a storey.
        let is_floor = |before: &PlaceCandidate| before.is_room && room_name(&before.name) == Some("basement");
        let qualifies = |before: &mut PlaceCandidate| before.to == place.from && !is_floor(before);
        if let Some(mut before) = candidates.pop_if(qualifies) {
            place.noun = before.noun;
            if !before.is_room && !place.is_room {
                before.name.push(' ');
                before.name.push_str(&place.name);
                place.name = before.name;
            }
        }
        candidates.push(place);
    }
    let (colours, numbers) = (PlaceColours::from_tokens(tokens), PlaceNumbers::from_tokens(tokens, others));
    let event = |place: PlaceCandidate| {
        let span = tokens.span_of(place.from, place.to - 1);
        let clause = clauses[place.from];
        let (side, end) = sides::side_after(tokens, place.to);
        let side = side.or_else(|| sides::side_before(tokens, place.noun));
        let link = link_before(tokens, clauses, place.from);
        let colour = colours.colour_before(place.from).or_else(|| colours.colour_behind(end));
        let going = motion_by_place(tokens, clauses, place.noun, &place.name);
        let (ordinal, count) = (numbers.ordinal_before(place.noun), numbers.count_before(place.noun));
        let several = count.is_some() || means_several(tokens.word_at(place.to - 1));
        let PlaceCandidate { name, is_thing, is_room, .. } = place;
        // `mark_turn_places` sets it.
        let tells_turn = false;
        let place =
            PlaceMention { name, is_thing, is_room, link, side, colour, tells_turn, going, ordinal, count, several };
        TextEvent { what: EventContent::Place(place), span, clause, denied: false }
    };
    candidates.into_iter().map(event).collect()
}

/// Whether a place is outside all of these spans: the face of "an about-face" belongs to a turn and is no place.
fn is_free_of(spans: &[[usize; 2]], tokens: TokenSlice<'_>, place: &PlaceCandidate) -> bool {
    let [from, to] = tokens.span_of(place.from, place.to - 1);
    // The spans ascend.
    let next = spans.partition_point(|span| span[1] <= from);
    spans.get(next).is_none_or(|span| to <= span[0])
}

/// For each token, whether it is outside all of these spans.
fn free_tokens(tokens: TokenSlice<'_>, taken: &[[usize; 2]]) -> Vec<bool> {
    let mut free = vec![true; tokens.len()];
    for span in taken {
        let within = tokens.first_from(span[0])..tokens.first_from(span[1]);
        free[within].fill(false);
    }
    free
}

/// The longest known name that begins at a token.
fn named_place_at(tokens: TokenSlice<'_>, at: usize, known: &BTreeSet<String>) -> Option<PlaceCandidate> {
    // Names of the evidence may have six words, even if those of the lexicon are shorter.
    let longest = longest_name().max(6).min(tokens.len() - at);
    (1..=longest).rev().find_map(|length| {
        let mut run = at..at + length;
        if !run.clone().all(|at| tokens.is_word(at)) || is_no_place(tokens, at, length) {
            return None;
        }
        let name = run.by_ref().map(|at| normal_word(tokens.word_at(at))).collect::<Vec<_>>().join(" ");
        let (is_thing, is_room) = (is_thing(&name) || known.contains(&name), is_room(&name));
        (is_thing || is_room).then_some(PlaceCandidate { noun: at, from: at, to: at + length, name, is_thing, is_room })
    })
}

/// The token after the longest known name that begins at a token.
pub(super) fn name_end(tokens: TokenSlice<'_>, at: usize, known: &BTreeSet<String>) -> Option<usize> {
    named_place_at(tokens, at, known).map(|found| found.to)
}

/// Whether a word counts paces and names no stairs: "a few steps beyond it", "a step inside".
fn is_pace(tokens: TokenSlice<'_>, at: usize) -> bool {
    const ONWARD: [&str; 15] = [
        "beyond", "past", "further", "farther", "forward", "forwards", "ahead", "away", "more", "back", "after",
        "before", "inside", "into", "outside",
    ];
    let is_counted = at > 0 && (v::FEW.contains(&tokens.word_at(at - 1)) || tokens.word_at(at - 1) == "a");
    let climbs = || (1..=4).any(|back| at >= back && matches!(tokens.word_at(at - back), "up" | "down"));
    let is_step = matches!(tokens.word_at(at), "step" | "steps" | "pace" | "paces");
    is_step && is_counted && ONWARD.contains(&tokens.word_at(at + 1)) && !climbs()
}

/// Whether words that can be a name are not one here: "step" and "turn back" of walking, "light blue", "water the
/// plant".
fn is_no_place(tokens: TokenSlice<'_>, at: usize, length: usize) -> bool {
    let word = |at: usize| tokens.word_at(at);
    if length > 1 {
        return false;
    }
    if task::is_task_verb(tokens, at) || is_unit(tokens, at) || is_pace(tokens, at) {
        return true;
    }
    let after_determiner = at > 0 && (v::DETERMINERS.contains(&word(at - 1)) || v::ADJECTIVES.contains(&word(at - 1)));
    // "The upper floor" is a storey, and not a floor that one sees.
    let storey = word(at) == "floor"
        && ((at > 0 && v::STOREYS.contains(&word(at - 1)))
            || (at > 1 && word(at - 1) == "a" && matches!(word(at - 2), "up" | "down")));
    let verb_like = matches!(
        word(at),
        "step"
            | "exit"
            | "light"
            | "book"
            | "frame"
            | "cover"
            | "bar"
            | "iron"
            | "pan"
            | "box"
            | "study"
            | "throw"
            | "map"
            | "print"
            | "case"
            | "glass"
            | "stage"
            | "board"
            | "mop"
            | "tap"
            | "landing"
            | "entry"
            | "opening"
            | "passage"
            | "runner"
            | "art"
            | "paper"
            | "tool"
            | "cap"
            | "remote"
            | "seat"
            | "post"
            | "rail"
    );
    let before_noun = is_thing(&normal_word(word(at + 1)))
        || is_room(&normal_word(word(at + 1)))
        || v::ADJECTIVES.contains(&word(at + 1));
    // "Once you step into the hall", "a slight step to the right".
    let paces = word(at) == "step"
        && matches!(word(at + 1), "to" | "into" | "in" | "inside" | "onto" | "out" | "outside" | "through" | "forward");
    let shade = word(at) == "light" && v::COLOURS.contains(&word(at + 1));
    // "There is no sign of a lamp".
    let of_something = matches!((word(at), word(at + 1)), ("sign", "of") | ("counter", "clockwise"));
    (verb_like && !after_determiner)
        || of_something
        || paces
        || (word(at) == "light" && before_noun && !after_determiner)
        || shade
        || storey
}

/// A noun phrase that begins at a token and has no known name: "the shiny gizmo".
fn unnamed_place_at(tokens: TokenSlice<'_>, at: usize, known: &BTreeSet<String>) -> Option<PlaceCandidate> {
    let word = |at: usize| tokens.word_at(at);
    let is_article = matches!(word(at), "the" | "a" | "an");
    if is_depicted(tokens, at) || !(is_article || begins_noun(tokens, at)) {
        return None;
    }
    let ends = |end: usize| {
        // "After this enter the hall", "on your left soon": not a noun.
        let first = word(end);
        let is_other = v::WALKING.contains(&first) || v::TURNING.contains(&first) || first.ends_with("ing");
        let is_verb = !is_article && end == at + 1 && (is_other || matches!(first, "left" | "right"));
        // "At the bottom hang a right".
        let is_turn = v::TURNING.contains(&first)
            && matches!((word(end + 1), word(end + 2)), ("left" | "right", _) | ("a", "left" | "right"));
        // "At the top keep straight on".
        let is_end = |at: usize| v::ABSTRACT.contains(&normal_word(word(at)).as_str());
        let goes_on = end > at + 1 && v::WALKING.contains(&first) && is_end(end - 1);
        tokens.get(end).is_none_or(|token| !token.is_word())
            || is_verb
            || goes_on
            || is_turn
            || v::BREAKERS.contains(&word(end))
            || (end > at + 1 && v::AFTER_NOUN.contains(&first))
            || named_place_at(tokens, end, known).is_some()
    };
    let mut to = at + 1;
    while to < at + 5 && !ends(to) {
        to += 1;
    }
    // Before a named place, these words are its adjectives.
    let ends_in_name = tokens.is_word(to) && named_place_at(tokens, to, known).is_some();
    let last = word(to - 1);
    let tells_nothing = v::ABSTRACT.contains(&normal_word(last).as_str())
        || v::ADJECTIVES.contains(&last)
        // "A sharp turn", "the way forward".
        || v::BEFORE_SIDE.contains(&last)
        || v::ONWARD.contains(&last)
        || last.ends_with("ly")
        || is_unit(tokens, to - 1)
        || is_pace(tokens, to - 1)
        || v::floor_number(last).is_some();
    if to == at + 1 || ends_in_name || tells_nothing {
        return None;
    }
    let name = (at + 1..to).map(|at| normal_word(word(at))).collect::<Vec<_>>().join(" ");
    Some(PlaceCandidate { noun: at + 1, from: at + 1, to, name, is_thing: true, is_room: false })
}

/// Whether a noun phrase names something in a picture, or far outside: the horses of "a picture of two horses", and the sea of
/// "a view of the sea", are not at the place.
fn is_depicted(tokens: TokenSlice<'_>, at: usize) -> bool {
    let word = |back: usize| at.checked_sub(back).map_or("", |at| tokens.word_at(at));
    if word(1) == "of" && word(2) == "view" {
        return true;
    }
    word(1) == "of" && find_thing(&normal_word(word(2))).is_some_and(|thing| thing.class == ThingClass::WallArt)
}

/// Whether a word other than an article begins a noun phrase: "my", "two", "past that".
fn begins_noun(tokens: TokenSlice<'_>, at: usize) -> bool {
    let word = tokens.word_at(at);
    if !matches!(word, "this" | "that" | "these" | "those") {
        return v::DETERMINERS.contains(&word) || v::COUNTING.contains(&word);
    }
    // "The door that leads on", "this takes you to the hall": here the word replaces a noun.
    let before = tokens.word_before(at);
    let begins_clause =
        matches!(before, "where" | "when" | "until" | "till" | "while" | "as" | "if" | "that" | "which" | "and" | "so");
    !begins_clause && (v::BREAKERS.contains(&before) || v::WALKING.contains(&before))
}

/// The first place of a text, for tests.
#[cfg(test)]
pub(super) fn first(text: &str) -> PlaceMention {
    let places = super::read_instruction(text, &BTreeSet::new()).events.into_iter();
    let mut place =
        places.filter_map(|event| if let EventContent::Place(place) = event.what { Some(place) } else { None });
    place.next().unwrap_or_else(|| panic!("{text} names no place"))
}

#[cfg(test)]
mod unnamed_tests {
    use crate::reading::{EventContent, read_instruction};
    use std::collections::BTreeSet;

    /// The names of the places that a text names.
    fn places(text: &str) -> Vec<String> {
        let events = read_instruction(text, &BTreeSet::new()).events.into_iter();
        let places = events
            .filter_map(|event| if let EventContent::Place(place) = event.what { Some(place.name) } else { None });
        places.collect()
    }

    #[test]
    fn words_about_a_turn_or_a_way_are_no_places() {
        for text in [
            "Make a sharp turn right.",
            "Make a hard turn left and wait.",
            "Take the one all the way to the left.",
            "Go the way forward.",
        ] {
            assert_eq!(places(text), Vec::<String>::new(), "{text}");
        }
    }

    #[test]
    fn a_name_ends_before_the_verb_that_goes_on() {
        assert_eq!(places("Exit the room using the frobnicator."), ["frobnicator"]);
        assert_eq!(places("Leave the room via the frobnicator."), ["frobnicator"]);
        assert_eq!(places("Stop by the gizmo holding a frobnicator."), ["gizmo", "frobnicator"]);
        assert_eq!(places("Stop by the room divider."), ["room divider"]);
        assert_eq!(places("Stop by the wooden flooring."), ["wooden flooring"]);
    }
}

//! Tests that the cost of reading grows in proportion to a text's length. They count looks at its tokens, because time
//! depends on the machine.

use super::{read_instruction, vocabulary as v};
use std::{cell::Cell, collections::BTreeSet};

thread_local! {
    static LOOKS: Cell<usize> = const { Cell::new(0) };
}

/// Counts one look at a token.
pub(super) fn count_look() {
    LOOKS.with(|looks| looks.set(looks.get() + 1));
}

/// The number of looks that reading a text takes.
fn looks_for(text: &str) -> usize {
    LOOKS.with(|looks| looks.set(0));
    let _ = read_instruction(text, &BTreeSet::new());
    LOOKS.with(Cell::get)
}

/// The parts to repeat: each word that steers the reading, alone and before the words that it steers, and phrases that
/// several readers look at.
fn repeated_parts() -> BTreeSet<String> {
    let lists = [
        &v::WALKING,
        &v::TURNING,
        &v::BEFORE_ABOUT,
        &v::BEFORE_CLIMB,
        &v::BEFORE_SIDE,
        &v::BEFORE_SIDE_OF_TURN,
        &v::AFTER_SIDE,
        &v::DETERMINERS,
        &v::COUNTING,
        &v::BREAKERS,
        &v::ABSTRACT,
        &v::BESIDE,
        &v::ADJECTIVES,
        &v::ADVERBS,
    ];
    let words = lists.iter().flat_map(|list| list.iter());
    let steered = ["", " left", " around", " up the stairs", " sofa", " level 2", " and", ","];
    let pairs = words.flat_map(|word| steered.map(|end| format!("{word}{end} ")));
    let more = [
        "sofa ",
        "the glass ",
        "turn left sofa ",
        "past the sofa ",
        "to the kitchen past the sofa ",
        "level 2 up the stairs ",
        "pass the sofa on level 2 and turn left, ",
        "do not turn left ",
        "a picture of a horse ",
        "in the bedroom on your left that is ",
        "on your left there is ",
        "the second left door ",
        "the end of ",
        "until you get to the sofa ",
        "there is no ",
        "if you see the sofa you have gone too far ",
        "if you have gone too far. ",
        "turn right twice ",
        "two lefts ",
        "turn clockwise 90 degrees ",
        "turn counter clockwise ",
        "head north ",
        "north east ",
        "two or three steps ",
        "a few feet ",
        "is dark green ",
        "stop facing the ",
        "with your back to the ",
        "switch on the ",
        "go up and ",
        "zorble ",
    ];
    pairs.chain(more.map(str::to_owned)).collect()
}

/// Checks that the looks grow in proportion to how often a part is repeated: 40 more repetitions take twice as many
/// more looks as 20 more do.
#[track_caller]
fn grows_in_proportion(text: impl Fn(usize) -> String) {
    let [few, more, many] = [20, 40, 80].map(|times| looks_for(&text(times)));
    assert!(10 * (many - more) <= 22 * (more - few), "{:?}: {few}, {more}, {many} looks", text(1));
}

#[test]
fn twice_the_text_takes_twice_the_looks() {
    for part in repeated_parts() {
        grows_in_proportion(|times| part.repeat(times));
    }
}

#[test]
fn words_between_a_turn_and_its_places_are_not_looked_at_for_each_place() {
    for part in ["sofa ", "sofa, ", "at the sofa "] {
        grows_in_proportion(|times| format!("Turn left {}", part.repeat(times)));
    }
}

//! What a text tells of a motion that nobody knows.

use super::finding;
use std::collections::BTreeSet;
use wayword_core::{Check, Finding, Verdict};
use wayword_language::{
    reading::{Event, What, read},
    text::{Token, tokens},
};

/// Words that count what is walked.
const COUNTS: &[&str] =
    &["one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "twenty", "few", "several"];
/// Units of what is walked.
const UNITS: &[&str] = &[
    "m", "metre", "metres", "meter", "meters", "ft", "foot", "feet", "yard", "yards", "pace", "paces", "step", "steps",
];

/// Turns, sides, stairs, floors and distances, even where the text denies them: who says "do not turn left" knows of a turn.
pub(super) fn made_up(text: &str, known: &BTreeSet<String>) -> Vec<Finding> {
    let events = read(text, known).events;
    let tokens = tokens(text);
    let told = events.iter().filter_map(|event| Some((told(event)?, event.span)));
    let on = tokens
        .iter()
        .filter(|token| token.word == "straight")
        .map(|token| ((Check::Turns, "which way it goes"), token.span));
    let distances = distances(&tokens).map(|span| ((Check::Turns, "how far it goes"), span));
    let all = told.chain(on).chain(distances);
    all.map(|((check, what), span)| {
        let words = text.get(span[0]..span[1]).unwrap_or_default();
        let reason = format!("{words:?}: nobody knows {what}; tell the way by rooms and things alone");
        finding(check, Verdict::Fail, reason, Some(span))
    })
    .collect()
}

/// What one has to know of a motion to say so, and the check that holds it against the path where that is known.
fn told(event: &Event) -> Option<(Check, &'static str)> {
    match &event.what {
        What::Turn(_) => Some((Check::Turns, "how the walk turns")),
        What::Climb(_) | What::Steps(_) => Some((Check::Floors, "whether it goes up or down")),
        What::Storey(_) | What::Floor(_) => Some((Check::Floors, "on which floor it is")),
        What::Place(place) => place.side.map(|_| (Check::Landmarks, "on which side of the walker that is")),
        What::Onward => None,
    }
}

/// "Three metres", "3m", "a few steps".
fn distances(tokens: &[Token]) -> impl Iterator<Item = [usize; 2]> {
    let is_digit = |c: char| c.is_ascii_digit() || c == '.';
    let is_number = move |word: &str| word.chars().all(is_digit) || COUNTS.contains(&word);
    let pairs = tokens.windows(2).filter(move |pair| is_number(&pair[0].word) && UNITS.contains(&&*pair[1].word));
    let one = tokens.iter().filter(move |token| {
        let unit = token.word.trim_start_matches(is_digit);
        unit.len() < token.word.len() && UNITS.contains(&unit)
    });
    pairs.map(|pair| [pair[0].span[0], pair[1].span[1]]).chain(one.map(|token| token.span))
}

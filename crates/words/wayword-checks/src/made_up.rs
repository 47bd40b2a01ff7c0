//! Finds statements about the motion in texts of our own writers where the motion is unknown. The writer cannot know
//! them, so it invented them.

use super::finding;
use std::collections::BTreeSet;
use wayword_core::{Check, Finding, Verdict};
use wayword_language::{
    reading::{Event, What, read},
    text::{Token, tokens},
};

/// Words that count how far one walks.
const COUNTS: &[&str] =
    &["one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "twenty", "few", "several"];
/// Units of how far one walks.
const UNITS: &[&str] = &[
    "m", "metre", "metres", "meter", "meters", "ft", "foot", "feet", "yard", "yards", "pace", "paces", "step", "steps",
];

/// Turns, sides, stairs, storeys and distances, even where the text denies them: "do not turn left" claims to know of a
/// turn.
pub(super) fn made_up(text: &str, known: &BTreeSet<String>) -> Vec<Finding> {
    let events = read(text, known).events;
    let tokens = tokens(text);
    let told = events.iter().filter_map(|event| Some((told(event)?, event.span)));
    let on = tokens
        .iter()
        .filter(|token| token.word == "straight")
        .map(|token| ((Check::Turns, "which way the path goes"), token.span));
    let distances = distances(&tokens).map(|span| ((Check::Turns, "how far the path goes"), span));
    let all = told.chain(on).chain(distances);
    all.map(|((check, what), span)| {
        let words = text.get(span[0]..span[1]).unwrap_or_default();
        let reason = format!("{words:?}: it is not known {what}; describe the way by rooms and objects alone");
        finding(check, Verdict::Fail, reason, Some(span))
    })
    .collect()
}

/// The fact that an author needs to know for a statement, and the check that decides it where the motion is known.
fn told(event: &Event) -> Option<(Check, &'static str)> {
    match &event.what {
        What::Turn(_) => Some((Check::Turns, "how the path turns")),
        What::Climb(_) | What::Steps(_) => Some((Check::Floors, "whether the path goes up or down")),
        What::Storey(_) | What::Floor(_) => Some((Check::Floors, "on which storey the path is")),
        What::Place(place) => place.side.map(|_| (Check::Landmarks, "on which side of the walker that is")),
        What::Onward | What::Stop | What::Face { .. } | What::Compass { .. } | What::Distance { .. } => None,
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

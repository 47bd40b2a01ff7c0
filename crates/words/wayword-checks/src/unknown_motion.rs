//! Finds statements about the motion in texts of our own writers where the motion is unknown. The writer cannot know
//! them, so it invented them.

use super::new_finding;
use std::collections::BTreeSet;
use wayword_core::{CheckFinding, CheckKind, Verdict};
use wayword_language::{
    reading::{EventContent, TextEvent, read_instruction},
    text::{TextToken, split_tokens},
};

/// Words that count how far one walks.
const DISTANCE_COUNT_WORDS: &[&str] =
    &["one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "twenty", "few", "several"];
/// Units of how far one walks.
const DISTANCE_UNIT_WORDS: &[&str] = &[
    "m", "metre", "metres", "meter", "meters", "ft", "foot", "feet", "yard", "yards", "pace", "paces", "step", "steps",
];

/// Turns, sides, stairs, storeys and distances, even where the text denies them: "do not turn left" claims to know of a
/// turn.
pub(super) fn find_made_up(text: &str, known: &BTreeSet<String>) -> Vec<CheckFinding> {
    let events = read_instruction(text, known).events;
    let tokens = split_tokens(text);
    let told = events.iter().filter_map(|event| Some((unknown_motion_fact(event)?, event.span)));
    let on = tokens
        .iter()
        .filter(|token| token.word == "straight")
        .map(|token| ((CheckKind::Turns, "which way the path goes"), token.span));
    let distances = distance_spans(&tokens).map(|span| ((CheckKind::Turns, "how far the path goes"), span));
    let all = told.chain(on).chain(distances);
    all.map(|((check, what), span)| {
        let words = text.get(span[0]..span[1]).unwrap_or_default();
        let reason = format!("{words:?}: it is not known {what}; describe the way by rooms and objects alone");
        new_finding(check, Verdict::Fail, reason, Some(span))
    })
    .collect()
}

/// The fact that an author needs to know for a statement, and the check that decides it where the motion is known.
fn unknown_motion_fact(event: &TextEvent) -> Option<(CheckKind, &'static str)> {
    match &event.what {
        EventContent::Turn(_) => Some((CheckKind::Turns, "how the path turns")),
        EventContent::Climb(_) | EventContent::Steps(_) => {
            Some((CheckKind::Floors, "whether the path goes up or down"))
        }
        EventContent::Storey(_) | EventContent::Floor(_) => Some((CheckKind::Floors, "on which storey the path is")),
        EventContent::Place(place) => place.side.map(|_| (CheckKind::Landmarks, "on which side of the walker that is")),
        EventContent::Onward
        | EventContent::Stop
        | EventContent::Face { .. }
        | EventContent::Compass { .. }
        | EventContent::Distance { .. } => None,
    }
}

/// "Three metres", "3m", "a few steps".
fn distance_spans(tokens: &[TextToken]) -> impl Iterator<Item = [usize; 2]> {
    let is_digit = |c: char| c.is_ascii_digit() || c == '.';
    let is_number = move |word: &str| word.chars().all(is_digit) || DISTANCE_COUNT_WORDS.contains(&word);
    let pairs =
        tokens.windows(2).filter(move |pair| is_number(&pair[0].word) && DISTANCE_UNIT_WORDS.contains(&&*pair[1].word));
    let one = tokens.iter().filter(move |token| {
        let unit = token.word.trim_start_matches(is_digit);
        unit.len() < token.word.len() && DISTANCE_UNIT_WORDS.contains(&unit)
    });
    pairs.map(|pair| [pair[0].span[0], pair[1].span[1]]).chain(one.map(|token| token.span))
}

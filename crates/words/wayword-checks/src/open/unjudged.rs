//! Lists the statements of a text that no rule judges: denials, which one of several a thing is, numbers and the
//! compass. A text with any of them is unverified, even if the rest of it is right.

use super::stretches::Stretches;
use crate::{Subject, evidence::NEAR_M, finding};
use std::collections::BTreeSet;
use wayword_core::{Check, Finding, Side, Verdict};
use wayword_language::{
    reading::{Event, Ordinal, Place, Reading, What, cardinal, ordinal},
    text::{Token, tokens},
};

/// From this number on, which one of several is meant, or how many there are, is a claim by itself. People say "the first
/// door" of the one before them, and "the two chairs" of those that they see.
const MANY: u32 = 3;
/// How far before a turn the words may be that give its number.
const WORDS_BEFORE: usize = 2;

/// The statements of a text that cannot be checked; `reading` still has its denied events.
pub(super) fn unjudged(text: &str, reading: &Reading, subject: Subject<'_>) -> Vec<Finding> {
    let tokens = tokens(text);
    let unverified = |check, reason: &str, span| finding(check, Verdict::Unverified, reason, Some(span));
    let mut found = turned_often(reading, subject);
    found.extend(stays(reading, subject));
    let (mut clauses, mut turns) = (BTreeSet::new(), BTreeSet::new());
    for event in &reading.events {
        if event.denied {
            let check = check_of(&event.what).filter(|_| !is_moment_too_far(&tokens, event.span));
            let reason = "the program does not check what a text denies";
            let first = check.filter(|_| clauses.insert(event.clause));
            found.extend(first.map(|check| unverified(check, reason, event.span)));
            continue;
        }
        match &event.what {
            What::Place(place) if is_counted(place, subject) => {
                let reason = "the program does not count which one of several this is, or how many there are";
                found.push(unverified(Check::Landmarks, reason, event.span));
            }
            What::Turn(_) if turns.insert(event.span) && is_numbered(&tokens, event.span) => {
                found.push(unverified(Check::Turns, "the program does not count which turn this is", event.span));
            }
            What::Compass { goes, .. } => {
                let check = if *goes { Check::Turns } else { Check::Landmarks };
                found.push(unverified(check, "the program does not know where north is", event.span));
            }
            _ => {}
        }
    }
    let often = times(&tokens).filter(|span| turns.iter().all(|turn| span[1] <= turn[0] || turn[1] <= span[0]));
    found.extend(often.map(|span| unverified(Check::Order, "the program does not count how often this is done", span)));
    found
}

/// The check that a statement belongs to.
fn check_of(what: &What) -> Option<Check> {
    match what {
        What::Place(_) => Some(Check::Landmarks),
        What::Turn(_) => Some(Check::Turns),
        What::Climb(_) | What::Steps(_) | What::Storey(_) | What::Floor(_) => Some(Check::Floors),
        What::Onward | What::Stop | What::Face { .. } | What::Compass { .. } | What::Distance { .. } => None,
    }
}

/// "Stay where you are." on a path that moves.
fn stays(reading: &Reading, subject: Subject<'_>) -> Option<Finding> {
    let moves_m: f64 = subject.evidence.moves.iter().map(|step| step.distance_m).sum();
    let stop = reading.events.iter().find(|event| event.what == What::Stop && !event.denied)?;
    let only_stops = reading.events.iter().all(|event| event.denied || event.what == What::Stop);
    let is_wrong = only_stops && subject.evidence.motion.is_known() && moves_m > NEAR_M;
    let reason = "the text only says to stop, and the path goes on";
    is_wrong.then(|| finding(Check::Order, Verdict::Unverified, reason, Some(stop.span)))
}

/// "If you see the bed, you have gone too far": that is no part of the walk.
fn is_moment_too_far(tokens: &[Token], span: [usize; 2]) -> bool {
    let mut sentences = tokens.split(Token::ends_sentence);
    let sentence = sentences.find(|sentence| sentence.last().is_some_and(|last| span[0] < last.span[1]));
    sentence.is_some_and(|sentence| sentence.windows(2).any(|pair| pair[0].word == "too" && pair[1].word == "far"))
}

/// Whether a text identifies a place among several, or names more of them than are listed near the path.
fn is_counted(place: &Place, subject: Subject<'_>) -> bool {
    let near = || subject.reach.surroundings.map_or(0, |around| around.spots(&place.name, NEAR_M).len());
    let has_number = matches!(place.ordinal, Some(Ordinal::Number(number)) if number >= MANY);
    has_number || place.count.is_some_and(|count| count >= MANY && near() < count as usize)
}

/// "Take the third left".
fn is_numbered(tokens: &[Token], span: [usize; 2]) -> bool {
    let at = tokens.partition_point(|token| token.span[0] < span[0]);
    let before = tokens[..at].iter().rev().take_while(|token| token.is_word()).take(WORDS_BEFORE);
    before.into_iter().any(|token| matches!(ordinal(&token.word), Some(Ordinal::Number(number)) if number >= MANY))
}

/// "Three times": its byte ranges.
fn times(tokens: &[Token]) -> impl Iterator<Item = [usize; 2]> {
    let is_often = |pair: &&[Token]| {
        matches!(pair[1].word.as_str(), "times") && cardinal(&pair[0].word).is_some_and(|number| number >= MANY)
    };
    tokens.windows(2).filter(is_often).map(|pair| [pair[0].span[0], pair[1].span[1]])
}

/// "Turn right five times", where the path turns to that side less often.
fn turned_often(reading: &Reading, subject: Subject<'_>) -> Vec<Finding> {
    if !subject.evidence.motion.is_known() {
        return Vec::new();
    }
    let side = |event: &Event| match event.what {
        What::Turn(side @ (Side::Left | Side::Right)) if !event.denied => Some(side),
        _ => None,
    };
    // The turns that one number counts have one clause, and no other event between them.
    let runs = reading.events.chunk_by(|a, b| side(a).is_some() && side(a) == side(b) && a.clause == b.clause);
    let wrong = |run: &[Event]| {
        let first = run.first()?;
        let side = side(first)?;
        let has_fewer = run.len() >= MANY as usize && Stretches::of(subject).turns(side) < run.len();
        let reason = "the text tells more turns to this side than the path has";
        has_fewer.then(|| finding(Check::Turns, Verdict::Fail, reason, Some(first.span)))
    };
    runs.filter_map(wrong).collect()
}

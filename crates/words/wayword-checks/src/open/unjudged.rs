//! Lists the statements of a text that no rule judges: denials, which one of several a thing is, numbers and the
//! compass. A text with any of them is unverified, even if the rest of it is right.

use super::stretches::PathStretches;
use crate::{CheckSubject, evidence::NEAR_M, new_finding};
use std::collections::BTreeSet;
use wayword_core::{CheckFinding, CheckKind, Side, Verdict};
use wayword_language::{
    reading::{EventContent, PlaceMention, PlaceOrdinal, TextEvent, TextReading, cardinal_number, ordinal_word},
    text::TextToken,
};

/// From this number on, which one of several is meant, or how many there are, is a claim by itself. People say "the first
/// door" of the one before them, and "the two chairs" of those that they see.
const MIN_COUNTED_NUMBER: u32 = 3;
/// How far before a turn the words may be that give its number, words.
const NUMBER_REACH_WORDS: usize = 2;

/// The statements of a text that cannot be checked; `reading` still has its denied events.
pub(super) fn find_unjudged(reading: &TextReading, subject: CheckSubject<'_>) -> Vec<CheckFinding> {
    let tokens = reading.tokens();
    let unverified = |check, reason: &str, span| new_finding(check, Verdict::Unverified, reason, Some(span));
    let mut found = find_missing_turns(reading, subject);
    found.extend(stay_on_moving_path(reading, subject));
    let (mut clauses, mut turns) = (BTreeSet::new(), BTreeSet::new());
    for event in &reading.events {
        if event.denied {
            let check = check_for_content(&event.what).filter(|_| !is_moment_too_far(tokens, event.span));
            let reason = "the program does not check what a text denies";
            let first = check.filter(|_| clauses.insert(event.clause));
            found.extend(first.map(|check| unverified(check, reason, event.span)));
            continue;
        }
        match &event.what {
            EventContent::Place(place) if is_counted(place, subject) => {
                let reason = "the program does not count which one of several this is, or how many there are";
                found.push(unverified(CheckKind::Landmarks, reason, event.span));
            }
            EventContent::Turn(_) if turns.insert(event.span) && is_numbered(tokens, event.span) => {
                found.push(unverified(CheckKind::Turns, "the program does not count which turn this is", event.span));
            }
            EventContent::Compass { goes, .. } => {
                let check = if *goes { CheckKind::Turns } else { CheckKind::Landmarks };
                found.push(unverified(check, "the program does not know where north is", event.span));
            }
            _ => {}
        }
    }
    let often =
        repetition_spans(tokens).filter(|span| turns.iter().all(|turn| span[1] <= turn[0] || turn[1] <= span[0]));
    found.extend(
        often.map(|span| unverified(CheckKind::Order, "the program does not count how often this is done", span)),
    );
    found
}

/// The check that a statement belongs to.
fn check_for_content(what: &EventContent) -> Option<CheckKind> {
    match what {
        EventContent::Place(_) => Some(CheckKind::Landmarks),
        EventContent::Turn(_) => Some(CheckKind::Turns),
        EventContent::Climb(_) | EventContent::Steps(_) | EventContent::Storey(_) | EventContent::Floor(_) => {
            Some(CheckKind::Floors)
        }
        EventContent::Onward
        | EventContent::Stop
        | EventContent::Face { .. }
        | EventContent::Compass { .. }
        | EventContent::Distance { .. } => None,
    }
}

/// "Stay where you are." on a path that moves.
fn stay_on_moving_path(reading: &TextReading, subject: CheckSubject<'_>) -> Option<CheckFinding> {
    let moves_m: f64 = subject.evidence.moves.iter().map(|step| step.distance_m).sum();
    let stop = reading.events.iter().find(|event| event.what == EventContent::Stop && !event.denied)?;
    let only_stops = reading.events.iter().all(|event| event.denied || event.what == EventContent::Stop);
    let is_wrong = only_stops && subject.evidence.motion.is_known() && moves_m > NEAR_M;
    let reason = "the text only says to stop, and the path goes on";
    is_wrong.then(|| new_finding(CheckKind::Order, Verdict::Unverified, reason, Some(stop.span)))
}

/// "If you see the bed, you have gone too far": that is no part of the walk.
fn is_moment_too_far(tokens: &[TextToken], span: [usize; 2]) -> bool {
    let mut sentences = tokens.split(TextToken::ends_sentence);
    let sentence = sentences.find(|sentence| sentence.last().is_some_and(|last| span[0] < last.span[1]));
    sentence.is_some_and(|sentence| sentence.windows(2).any(|pair| pair[0].word == "too" && pair[1].word == "far"))
}

/// Whether a text identifies a place among several, or names more of them than are listed near the path.
fn is_counted(place: &PlaceMention, subject: CheckSubject<'_>) -> bool {
    let near = || subject.reach.surroundings.map_or(0, |around| around.thing_spots(&place.name, NEAR_M).len());
    let has_number = matches!(place.ordinal, Some(PlaceOrdinal::Number(number)) if number >= MIN_COUNTED_NUMBER);
    has_number || place.count.is_some_and(|count| count >= MIN_COUNTED_NUMBER && near() < count as usize)
}

/// Whether the words before a turn number it: "take the third left".
fn is_numbered(tokens: &[TextToken], span: [usize; 2]) -> bool {
    let at = tokens.partition_point(|token| token.span[0] < span[0]);
    let before = tokens[..at].iter().rev().take_while(|token| token.is_word()).take(NUMBER_REACH_WORDS);
    before.into_iter().any(
        |token| matches!(ordinal_word(&token.word), Some(PlaceOrdinal::Number(number)) if number >= MIN_COUNTED_NUMBER),
    )
}

/// "Three times": its byte ranges.
fn repetition_spans(tokens: &[TextToken]) -> impl Iterator<Item = [usize; 2]> {
    let is_often = |pair: &&[TextToken]| {
        matches!(pair[1].word.as_str(), "times")
            && cardinal_number(&pair[0].word).is_some_and(|number| number >= MIN_COUNTED_NUMBER)
    };
    tokens.windows(2).filter(is_often).map(|pair| [pair[0].span[0], pair[1].span[1]])
}

/// "Turn right five times", where the path turns to that side less often.
fn find_missing_turns(reading: &TextReading, subject: CheckSubject<'_>) -> Vec<CheckFinding> {
    if !subject.evidence.motion.is_known() {
        return Vec::new();
    }
    let side = |event: &TextEvent| match event.what {
        EventContent::Turn(side @ (Side::Left | Side::Right)) if !event.denied => Some(side),
        _ => None,
    };
    // The turns that one number counts have one clause, and no other event between them.
    let runs = reading.events.chunk_by(|a, b| side(a).is_some() && side(a) == side(b) && a.clause == b.clause);
    let wrong = |run: &[TextEvent]| {
        let first = run.first()?;
        let side = side(first)?;
        let has_fewer = run.len() >= MIN_COUNTED_NUMBER as usize
            && PathStretches::from_subject(subject).count_turns(side) < run.len();
        let reason = "the text tells more turns to this side than the path has";
        has_fewer.then(|| new_finding(CheckKind::Turns, Verdict::Fail, reason, Some(first.span)))
    };
    runs.filter_map(wrong).collect()
}

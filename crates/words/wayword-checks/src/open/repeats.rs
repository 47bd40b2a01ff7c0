//! Finds statements that a text repeats although the path has too few stretches of them. Language models repeat
//! themselves so.

use super::{claims::read_claims, motions, relation::WalkerRelation, stretches::PathStretches};
use crate::{CheckSubject, new_finding};
use std::collections::BTreeMap;
use wayword_core::{CheckFinding, CheckKind, Verdict};
use wayword_language::{
    reading::{EventContent, TextReading},
    text::TextToken,
};

/// A sentence of at least this many words fails where it is repeated, however many stretches of it the path has.
const LONG_SENTENCE_WORDS: usize = 8;

/// The repetitions of a text: whole sentences, and the same motion by the same place.
pub(crate) fn check_repeats(reading: &TextReading, subject: CheckSubject<'_>) -> Vec<CheckFinding> {
    if !subject.evidence.motion.is_known() {
        return Vec::new();
    }
    let stretches = PathStretches::from_subject(subject);
    let mut found = repeated_sentences(reading, &stretches);
    let repeated: Vec<[usize; 2]> = found.iter().filter_map(|finding| finding.span).collect();
    let outside = |span: [usize; 2]| repeated.iter().all(|other| span[1] <= other[0] || other[1] <= span[0]);
    let twice = "the text says this a second time, and the path has one stretch of it";
    let past = "the text goes past the place at which it stops";
    let motions = motions::repeated_motions(reading, &stretches).into_iter().map(|span| (span, twice));
    let motions = motions.chain(motions::past_the_stop(reading).map(|span| (span, past)));
    let motions = motions.filter(|(span, _)| outside(*span));
    let wrong = |(span, reason)| new_finding(CheckKind::Order, Verdict::Fail, reason, Some(span));
    found.extend(motions.map(wrong).collect::<Vec<_>>());
    found
}

/// Sentences that occur twice in the same words.
fn repeated_sentences(reading: &TextReading, stretches: &PathStretches<'_>) -> Vec<CheckFinding> {
    let mut sentence_counts: BTreeMap<Vec<&str>, usize> = BTreeMap::new();
    let mut before: Vec<&str> = Vec::new();
    let mut found = Vec::new();
    let claims = read_claims(reading);
    for sentence in reading.tokens().split(TextToken::ends_sentence) {
        let words: Vec<&TextToken> = sentence.iter().filter(|token| token.is_word()).collect();
        let (Some(first), Some(last)) = (words.first(), words.last()) else { continue };
        let span = [first.span[0], last.span[1]];
        let within = |inner: [usize; 2]| span[0] <= inner[0] && inner[1] <= span[1];
        let spelt: Vec<&str> = words.iter().map(|token| token.word.as_str()).collect();
        let is_in_a_row = std::mem::replace(&mut before, spelt.clone()) == spelt;
        let times = sentence_counts.entry(spelt).or_default();
        *times += 1;
        if *times == 1 {
            continue;
        }
        // "Turn left. Walk on. Turn left. Walk on.": sentences as short as these may well be repeated.
        let stretch_count = |what: &EventContent| match what {
            EventContent::Turn(side) => Some(stretches.count_turns(*side)),
            EventContent::Climb(climb) | EventContent::Steps(climb) => Some(stretches.count_climbs(*climb)),
            _ => None,
        };
        let events = || reading.events.iter().filter(|event| within(event.span));
        let moves = events().filter_map(|event| stretch_count(&event.what));
        let places =
            claims.iter().filter(|claim| within(claim.span)).filter(|claim| claim.relation != WalkerRelation::Beside);
        let counts: Vec<usize> = moves.chain(places.map(|claim| stretches.count_places(claim))).collect();
        let has_all = counts.iter().all(|count| *count >= *times);
        if is_in_a_row || words.len() >= LONG_SENTENCE_WORDS || !has_all {
            let reason = match is_in_a_row {
                true => "the text says this sentence twice in a row",
                false => "the text says this sentence again, and the path has fewer stretches of it",
            };
            found.push(new_finding(CheckKind::Order, Verdict::Fail, reason, Some(span)));
        }
    }
    found
}

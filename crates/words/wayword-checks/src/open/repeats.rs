//! Finds statements that a text repeats although the path has too few stretches of them. Language models repeat
//! themselves so.

use super::{claims::claims, motions, relation::Relation, stretches::Stretches};
use crate::{Subject, finding};
use std::collections::BTreeMap;
use wayword_core::{Check, Finding, Verdict};
use wayword_language::{
    reading::{Reading, What},
    text::{Token, tokens},
};

/// A sentence of this many words is never repeated for another stretch, however many there are.
const MANY_WORDS: usize = 8;

/// The repetitions of a text: whole sentences, and the same motion by the same place.
pub(super) fn repeats(text: &str, reading: &Reading, subject: Subject<'_>) -> Vec<Finding> {
    if !subject.evidence.motion.is_known() {
        return Vec::new();
    }
    let stretches = Stretches::of(subject);
    let tokens = tokens(text);
    let mut found = sentences(&tokens, reading, &stretches);
    let said: Vec<[usize; 2]> = found.iter().filter_map(|finding| finding.span).collect();
    let outside = |span: [usize; 2]| said.iter().all(|other| span[1] <= other[0] || other[1] <= span[0]);
    let twice = "the text says this a second time, and the path has one stretch of it";
    let past = "the text goes past the place at which it stops";
    let motions = motions::told_twice(&tokens, reading, &stretches).into_iter().map(|span| (span, twice));
    let motions = motions.chain(motions::past_the_stop(&tokens, reading).map(|span| (span, past)));
    let motions = motions.filter(|(span, _)| outside(*span));
    let wrong = |(span, reason)| finding(Check::Order, Verdict::Fail, reason, Some(span));
    found.extend(motions.map(wrong).collect::<Vec<_>>());
    found
}

/// Sentences that occur twice in the same words.
fn sentences(tokens: &[Token], reading: &Reading, stretches: &Stretches<'_>) -> Vec<Finding> {
    let mut said: BTreeMap<Vec<&str>, usize> = BTreeMap::new();
    let mut before: Vec<&str> = Vec::new();
    let mut found = Vec::new();
    let claims = claims(reading);
    for sentence in tokens.split(Token::ends_sentence) {
        let words: Vec<&Token> = sentence.iter().filter(|token| token.is_word()).collect();
        let (Some(first), Some(last)) = (words.first(), words.last()) else { continue };
        let span = [first.span[0], last.span[1]];
        let within = |of: [usize; 2]| span[0] <= of[0] && of[1] <= span[1];
        let spelt: Vec<&str> = words.iter().map(|token| token.word.as_str()).collect();
        let at_once = std::mem::replace(&mut before, spelt.clone()) == spelt;
        let times = said.entry(spelt).or_default();
        *times += 1;
        if *times == 1 {
            continue;
        }
        // "Turn left. Walk on. Turn left. Walk on.": sentences as short as these may well be repeated.
        let told = |what: &What| match what {
            What::Turn(side) => Some(stretches.turns(*side)),
            What::Climb(climb) | What::Steps(climb) => Some(stretches.climbs(*climb)),
            _ => None,
        };
        let events = || reading.events.iter().filter(|event| within(event.span));
        let moves = events().filter_map(|event| told(&event.what));
        let places =
            claims.iter().filter(|claim| within(claim.span)).filter(|claim| claim.relation != Relation::Beside);
        let counts: Vec<usize> = moves.chain(places.map(|claim| stretches.places(claim))).collect();
        let has_all = counts.iter().all(|count| *count >= *times);
        if at_once || words.len() >= MANY_WORDS || !has_all {
            let reason = match at_once {
                true => "the text says this sentence twice in a row",
                false => "the text says this sentence again, and the path has fewer stretches of it",
            };
            found.push(finding(Check::Order, Verdict::Fail, reason, Some(span)));
        }
    }
    found
}

//! What a text says twice, where the path has no two stretches of it.

use super::{
    claims::{Claim, claims},
    relation::Relation,
    stretches::Stretches,
};
use crate::{Subject, finding};
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{Check, Finding, Verdict};
use wayword_language::{
    lexicon::{kinds, room_name},
    reading::{Reading, What},
    text::{Token, tokens},
};

/// A sentence of this many words is not said twice of two stretches, however many there are.
const MANY_WORDS: usize = 6;

/// What is said twice: whole sentences, and the same motion by the same place.
pub(super) fn repeats(text: &str, reading: &Reading, subject: Subject<'_>) -> Vec<Finding> {
    if !subject.evidence.motion.is_known() {
        return Vec::new();
    }
    let stretches = Stretches::of(subject);
    let tokens = tokens(text);
    let mut found = sentences(&tokens, reading, &stretches);
    let said: Vec<[usize; 2]> = found.iter().filter_map(|finding| finding.span).collect();
    let outside = |span: [usize; 2]| said.iter().all(|other| span[1] <= other[0] || other[1] <= span[0]);
    found.extend(motions(&tokens, reading, &stretches).into_iter().filter(|span| outside(*span)).map(|span| {
        let reason = "the text says this a second time, and the path has one stretch of it";
        finding(Check::Order, Verdict::Fail, reason, Some(span))
    }));
    found
}

/// Sentences that are said twice in the same words.
fn sentences(tokens: &[Token], reading: &Reading, stretches: &Stretches<'_>) -> Vec<Finding> {
    let mut said: BTreeSet<Vec<&str>> = BTreeSet::new();
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
        let is_new = said.insert(spelt);
        if is_new {
            continue;
        }
        // "Turn left. Walk on. Turn left. Walk on.": such sentences may well be said twice.
        let told = |what: &What| match what {
            What::Turn(side) => Some(stretches.turns(*side)),
            What::Climb(climb) | What::Steps(climb) => Some(stretches.climbs(*climb)),
            _ => None,
        };
        let moves = reading.events.iter().filter(|event| within(event.span)).filter_map(|event| told(&event.what));
        let places =
            claims.iter().filter(|claim| within(claim.span)).filter(|claim| claim.relation != Relation::Beside);
        let counts: Vec<usize> = moves.chain(places.map(|claim| stretches.places(claim))).collect();
        let has_two = !counts.is_empty() && counts.iter().all(|count| *count >= 2);
        if at_once || words.len() >= MANY_WORDS || !has_two {
            let reason = "the text says this sentence a second time, and the path has one stretch of it";
            found.push(finding(Check::Order, Verdict::Fail, reason, Some(span)));
        }
    }
    found
}

/// The places that the same motion has a second time.
fn motions(tokens: &[Token], reading: &Reading, stretches: &Stretches<'_>) -> Vec<[usize; 2]> {
    let mut said: BTreeMap<(Relation, String), usize> = BTreeMap::new();
    let mut found = Vec::new();
    let claims = claims(reading);
    let told_apart = |claim: &Claim| match &reading.events[claim.event].what {
        What::Place(place) => place.ordinal.is_some() || place.several,
        _ => false,
    };
    // "Into the next hallway": there are several.
    let several: BTreeSet<String> = claims.iter().filter(|claim| told_apart(claim)).map(name).collect();
    for claim in claims {
        let is_motion = matches!(claim.relation, Relation::Enter | Relation::Exit | Relation::Through | Relation::Past);
        if !is_motion || several.contains(&name(&claim)) || looks_back(tokens, &claim) {
            continue;
        }
        let clause = reading.events[claim.event].clause;
        let Some(before) = said.insert((claim.relation, name(&claim)), clause) else { continue };
        if before != clause && stretches.places(&claim) == 1 {
            found.push(claim.span);
        }
    }
    found
}

/// The name by which a claim is compared.
fn name(claim: &Claim) -> String {
    match room_name(&claim.name).filter(|_| claim.is_room) {
        Some(room) => room.to_owned(),
        None => kinds(&claim.name).swap_remove(0),
    }
}

/// Words before a place that take up again what was said, or that name another one.
const TAKING_UP: &[&str] = &[
    "once",
    "after",
    "when",
    "as",
    "if",
    "until",
    "till",
    "in",
    "while",
    "from",
    "another",
    "other",
    "next",
    "second",
    "third",
    "last",
    "again",
    "continue",
    "keep",
    "back",
    "immediately",
];

/// Whether the sentence before a claim takes up what was said: "once past the sofa", "another door".
fn looks_back(tokens: &[Token], claim: &Claim) -> bool {
    let at = tokens.partition_point(|token| token.span[0] < claim.span[0]);
    let clause = tokens[..at].iter().rev().take_while(|token| token.is_word()).take(9);
    clause.into_iter().any(|token| TAKING_UP.contains(&token.word.as_str()))
}

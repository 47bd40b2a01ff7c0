//! Turn words, stairs and floors.

use super::{Event, What, vocabulary as v};
use crate::text::Token;
use wayword_core::{Climb, Side};

fn side_word(word: &str) -> Option<Side> {
    match word {
        "left" | "leftward" | "leftwards" => Some(Side::Left),
        "right" | "rightward" | "rightwards" => Some(Side::Right),
        _ => None,
    }
}

/// The turns of a text.
pub(super) fn turns(tokens: &[Token], clauses: &[usize]) -> Vec<Event> {
    let word = |at: usize| tokens.get(at).map_or("", |token| token.word.as_str());
    let mut turns: Vec<Event> = Vec::new();
    for at in 0..tokens.len() {
        let told_before = turns
            .last()
            .is_some_and(|turn| sentence_of(tokens, turn.span[0]) == sentence_of(tokens, tokens[at].span[0]));
        let around = matches!(word(at), "around" | "180" | "back")
            && at > 0
            && matches!(word(at - 1), "turn" | "turned" | "turning");
        let side = if around {
            Some(Side::Behind)
        } else {
            side_word(word(at)).filter(|side| is_turn(tokens, at, *side, told_before))
        };
        if let Some(side) = side {
            turns.push(Event { what: What::Turn(side), span: tokens[at].span, clause: clauses[at] });
        }
    }
    turns
}

fn sentence_of(tokens: &[Token], at: usize) -> usize {
    tokens.iter().take_while(|token| token.span[0] < at).filter(|token| token.ends_sentence()).count()
}

/// Whether the side word at `at` tells a turn and not where something is.
fn is_turn(tokens: &[Token], at: usize, side: Side, told_before: bool) -> bool {
    let word = |at: usize| tokens.get(at).map_or("", |token| token.word.as_str());
    let after = word(at + 1);
    if matches!(after, "of" | "side" | "hand" | "wall" | "corner" | "most") {
        return false;
    }
    if after == "turn" {
        return true;
    }
    // What stands right before the side, without the words that may come between.
    let mut before = at;
    while before > 0 && v::BEFORE_SIDE.contains(&word(before - 1)) {
        before -= 1;
    }
    let directly = before == at;
    let verb = if before > 0 { word(before - 1) } else { "" };
    if side == Side::Right && directly && v::AFTER_ADVERB_RIGHT.contains(&after) && !v::TURNING.contains(&verb) {
        return false;
    }
    if v::TURNING.contains(&verb) {
        return true;
    }
    let skipped: Vec<&str> = (before..at).map(word).collect();
    if v::GOING.contains(&verb) {
        return directly
            || skipped.contains(&"to")
            || skipped.iter().all(|word| matches!(*word, "immediately" | "slightly" | "then"));
    }
    let begins_clause = verb.is_empty() || verb == "," || verb == ".";
    told_before
        && (skipped.iter().any(|word| matches!(*word, "then" | "another" | "again"))
            || (begins_clause && !skipped.contains(&"to")))
        || begins_clause && skipped.is_empty() && matches!(after, "at" | "into" | "through" | "," | "onto" | "down")
}

/// The climbs and floors of a text.
pub(super) fn climbs_and_floors(tokens: &[Token], clauses: &[usize]) -> Vec<Event> {
    let word = |at: usize| tokens.get(at).map_or("", |token| token.word.as_str());
    let is_stairs =
        |word: &str| matches!(word, "stairs" | "stair" | "staircase" | "steps" | "stairway" | "flight" | "stairwell");
    let stairs_follow =
        |at: usize| (at + 1..=at + 5).map(word).take_while(|word| *word != "." && *word != ",").any(is_stairs);
    let mut events = Vec::new();
    for at in 0..tokens.len() {
        let climb = match word(at) {
            "upstairs" => Some(Climb::Up),
            "downstairs" => Some(Climb::Down),
            "up" | "climb" | "climbing" | "ascend" if stairs_follow(at) && word(at + 1) != "to" => Some(Climb::Up),
            "down" | "descend" | "descending" if stairs_follow(at) && word(at + 1) != "to" => Some(Climb::Down),
            _ => None,
        };
        let said_already = |climb: Climb| matches!(events.last(), Some(Event { what: What::Climb(last), clause, .. }) if *last == climb && *clause == clauses[at]);
        if let Some(climb) = climb.filter(|climb| !said_already(*climb)) {
            events.push(Event { what: What::Climb(climb), span: tokens[at].span, clause: clauses[at] });
        }
        if let Some((number, last)) = floor(tokens, at) {
            let span = [tokens[at].span[0], tokens[last].span[1]];
            events.push(Event { what: What::Floor(number), span, clause: clauses[at] });
        }
    }
    events
}

/// A floor that begins at a token, and its last token: "level 2", "second floor", "2nd level".
fn floor(tokens: &[Token], at: usize) -> Option<(u32, usize)> {
    let word = |at: usize| tokens.get(at).map_or("", |token| token.word.as_str());
    let is_floor = |word: &str| matches!(word, "floor" | "level" | "story" | "storey");
    if is_floor(word(at)) && !(at > 0 && v::floor_number(word(at - 1)).is_some()) {
        return v::floor_number(word(at + 1)).map(|number| (number, at + 1));
    }
    let number = v::floor_number(word(at)).filter(|_| is_floor(word(at + 1)))?;
    Some((number, at + 1))
}

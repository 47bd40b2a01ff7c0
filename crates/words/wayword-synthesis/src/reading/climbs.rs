//! Stairs and floors.

use super::{Event, What, vocabulary as v};
use crate::text::Token;
use wayword_core::Climb;

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

//! Finds words of the compass: "head north", "the east wall".

use super::{CompassDirection, EventContent, TextEvent, tokens::TokenSlice, vocabulary as v};
use crate::lexicon::{is_room, is_thing, normal_word};

/// The directions of the compass that a text names.
pub(super) fn compass_events(tokens: TokenSlice<'_>, clauses: &[usize]) -> Vec<TextEvent> {
    let mut events = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let found =
            direction_at(tokens, at).and_then(|(towards, end)| Some((towards, end, leads_there(tokens, at, end)?)));
        if let Some((towards, end, goes)) = found {
            let what = EventContent::Compass { towards, goes };
            events.push(TextEvent { what, span: tokens.span_of(at, end - 1), clause: clauses[at], denied: false });
        }
        at = found.map_or(at + 1, |(_, end, _)| end);
    }
    events
}

/// The direction that the words from a token on name, and the token behind them.
fn direction_at(tokens: TokenSlice<'_>, at: usize) -> Option<(CompassDirection, usize)> {
    let (first, second) = (direction_from_word(tokens.word_at(at))?, direction_from_word(tokens.word_at(at + 1)));
    // "North-east".
    match second.and_then(|second| join_directions(first, second)) {
        Some(both) => Some((both, at + 2)),
        None => Some((first, at + 1)),
    }
}

/// The direction that a word names: "north", "northern", "northwards".
fn direction_from_word(word: &str) -> Option<CompassDirection> {
    let stem = ["wards", "ward", "erly", "ern"].iter().find_map(|end| word.strip_suffix(end)).unwrap_or(word);
    match stem {
        "north" => Some(CompassDirection::North),
        "northeast" => Some(CompassDirection::NorthEast),
        "east" => Some(CompassDirection::East),
        "southeast" => Some(CompassDirection::SouthEast),
        "south" => Some(CompassDirection::South),
        "southwest" => Some(CompassDirection::SouthWest),
        "west" => Some(CompassDirection::West),
        "northwest" => Some(CompassDirection::NorthWest),
        _ => None,
    }
}

/// "Northeast" for "north" and "east"; `None` where the two do not go together.
fn join_directions(first: CompassDirection, second: CompassDirection) -> Option<CompassDirection> {
    match (first, second) {
        (CompassDirection::North, CompassDirection::East) => Some(CompassDirection::NorthEast),
        (CompassDirection::North, CompassDirection::West) => Some(CompassDirection::NorthWest),
        (CompassDirection::South, CompassDirection::East) => Some(CompassDirection::SouthEast),
        (CompassDirection::South, CompassDirection::West) => Some(CompassDirection::SouthWest),
        _ => None,
    }
}

/// Whether the walk goes or turns that way; `None` where the words are only a name ("the West Wing poster").
fn leads_there(tokens: TokenSlice<'_>, at: usize, end: usize) -> Option<bool> {
    let is_joint = |word: &str| {
        matches!(word, "to" | "the" | "towards" | "toward" | "due" | "directly" | "straight" | "slightly" | "further")
    };
    let verb =
        (at.saturating_sub(4)..at).rev().find(|at| !is_joint(tokens.word_at(*at))).map_or("", |at| tokens.word_at(at));
    let is_verb = v::GOING.contains(&verb)
        || v::TURNING.contains(&verb)
        || v::CLIMBING.contains(&verb)
        || matches!(verb, "facing" | "looking" | "look" | "degrees");
    let next = tokens.word_at(end);
    let name = normal_word(next);
    let is_side = v::HAVE_SIDES.contains(&next)
        || matches!(next, "wall" | "side" | "corner" | "facing" | "entrance" | "exit")
        || is_thing(&name)
        || is_room(&name);
    let ends = !tokens.is_word(end) || v::BREAKERS.contains(&next);
    let to_the = matches!(tokens.word_before(at), "the" | "to" | "towards" | "toward" | "your") && ends;
    match (is_side, is_verb && ends) {
        (true, _) => Some(false),
        (false, true) => Some(true),
        (false, false) => to_the.then_some(false),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::read_instruction;
    use std::collections::BTreeSet;

    fn told(text: &str) -> Vec<(CompassDirection, bool)> {
        let events = read_instruction(text, &BTreeSet::new()).events.into_iter();
        let compass = |event: TextEvent| match event.what {
            EventContent::Compass { towards, goes } => Some((towards, goes)),
            _ => None,
        };
        events.filter_map(compass).collect()
    }

    #[test]
    fn compass_finds_ways_and_places() {
        for (text, towards, goes) in [
            ("Head north.", CompassDirection::North, true),
            ("Turn to the south-west and stop.", CompassDirection::SouthWest, true),
            ("Walk northeast past the sofa.", CompassDirection::NorthEast, true),
            ("Face east.", CompassDirection::East, true),
            ("Walk westwards.", CompassDirection::West, true),
            ("Stop at the east wall.", CompassDirection::East, false),
            ("Take the door on the northern side.", CompassDirection::North, false),
            ("The bed is to the south.", CompassDirection::South, false),
        ] {
            assert_eq!(told(text), [(towards, goes)], "{text}");
        }
        for text in ["Stop at the North Star sign.", "Walk to the Western Saloon sign."] {
            assert_eq!(told(text), [], "{text}");
        }
    }
}

//! Finds words of the compass: "head north", "the east wall".

use super::{Compass, Event, What, tokens::Tokens, vocabulary as v};
use crate::lexicon::{is_room, is_thing, normal_word};

/// The directions of the compass that a text names.
pub(super) fn compass(tokens: Tokens<'_>, clauses: &[usize]) -> Vec<Event> {
    let mut events = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let found = named(tokens, at).and_then(|(towards, end)| Some((towards, end, goes(tokens, at, end)?)));
        if let Some((towards, end, goes)) = found {
            let what = What::Compass { towards, goes };
            events.push(Event { what, span: tokens.span(at, end - 1), clause: clauses[at], denied: false });
        }
        at = found.map_or(at + 1, |(_, end, _)| end);
    }
    events
}

/// The direction that the words from a token on name, and the token behind them.
fn named(tokens: Tokens<'_>, at: usize) -> Option<(Compass, usize)> {
    let (first, second) = (of_word(tokens.word(at))?, of_word(tokens.word(at + 1)));
    // "North-east".
    match second.and_then(|second| between(first, second)) {
        Some(both) => Some((both, at + 2)),
        None => Some((first, at + 1)),
    }
}

fn of_word(word: &str) -> Option<Compass> {
    let stem = ["wards", "ward", "erly", "ern"].iter().find_map(|end| word.strip_suffix(end)).unwrap_or(word);
    match stem {
        "north" => Some(Compass::North),
        "northeast" => Some(Compass::NorthEast),
        "east" => Some(Compass::East),
        "southeast" => Some(Compass::SouthEast),
        "south" => Some(Compass::South),
        "southwest" => Some(Compass::SouthWest),
        "west" => Some(Compass::West),
        "northwest" => Some(Compass::NorthWest),
        _ => None,
    }
}

fn between(first: Compass, second: Compass) -> Option<Compass> {
    match (first, second) {
        (Compass::North, Compass::East) => Some(Compass::NorthEast),
        (Compass::North, Compass::West) => Some(Compass::NorthWest),
        (Compass::South, Compass::East) => Some(Compass::SouthEast),
        (Compass::South, Compass::West) => Some(Compass::SouthWest),
        _ => None,
    }
}

/// Whether the walk goes or turns that way; `None` where the words are only a name ("the West Wing poster").
fn goes(tokens: Tokens<'_>, at: usize, end: usize) -> Option<bool> {
    let is_joint = |word: &str| {
        matches!(word, "to" | "the" | "towards" | "toward" | "due" | "directly" | "straight" | "slightly" | "further")
    };
    let verb = (at.saturating_sub(4)..at).rev().find(|at| !is_joint(tokens.word(*at))).map_or("", |at| tokens.word(at));
    let is_verb = v::GOING.contains(&verb)
        || v::TURNING.contains(&verb)
        || v::CLIMBING.contains(&verb)
        || matches!(verb, "facing" | "looking" | "look" | "degrees");
    let next = tokens.word(end);
    let name = normal_word(next);
    let is_side = v::HAVE_SIDES.contains(&next)
        || matches!(next, "wall" | "side" | "corner" | "facing" | "entrance" | "exit")
        || is_thing(&name)
        || is_room(&name);
    let ends = !tokens.is_word(end) || v::BREAKERS.contains(&next);
    let to_the = matches!(tokens.before(at), "the" | "to" | "towards" | "toward" | "your") && ends;
    match (is_side, is_verb && ends) {
        (true, _) => Some(false),
        (false, true) => Some(true),
        (false, false) => to_the.then_some(false),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::read;
    use std::collections::BTreeSet;

    fn told(text: &str) -> Vec<(Compass, bool)> {
        let events = read(text, &BTreeSet::new()).events.into_iter();
        let compass = |event: Event| match event.what {
            What::Compass { towards, goes } => Some((towards, goes)),
            _ => None,
        };
        events.filter_map(compass).collect()
    }

    #[test]
    fn compass_finds_ways_and_places() {
        for (text, towards, goes) in [
            ("Head north.", Compass::North, true),
            ("Turn to the south-west and stop.", Compass::SouthWest, true),
            ("Walk northeast past the sofa.", Compass::NorthEast, true),
            ("Face east.", Compass::East, true),
            ("Walk westwards.", Compass::West, true),
            ("Stop at the east wall.", Compass::East, false),
            ("Take the door on the northern side.", Compass::North, false),
            ("The bed is to the south.", Compass::South, false),
        ] {
            assert_eq!(told(text), [(towards, goes)], "{text}");
        }
        for text in ["Stop at the North Star sign.", "Walk to the Western Saloon sign."] {
            assert_eq!(told(text), [], "{text}");
        }
    }
}

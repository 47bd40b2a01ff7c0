//! Reads an instruction as the checker sees it: landmarks, rooms, turns, climbs and floors in the order of the text, and
//! the closing task.
//!
//! The reader knows nothing of any writer: it takes the words of people, of models and of our own writer alike.

mod climbs;
mod links;
mod places;
mod task;
mod turns;
pub(crate) mod vocabulary;

use crate::text::{Token, tokens};
use std::collections::BTreeSet;
use wayword_core::{Climb, Side};

/// What an instruction says, in the order of its text.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Everything that can be held against a path.
    pub events: Vec<Event>,
    /// The closing task, where the text ends in one.
    pub task: Option<Task>,
}

/// One thing that an instruction says.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// What it is.
    pub what: What,
    /// Its byte range in the text.
    pub span: [usize; 2],
    /// The clause that it stands in, counted over the whole text.
    pub clause: usize,
}

/// The kinds of things that instructions say.
#[derive(Debug, Clone, PartialEq)]
pub enum What {
    /// An object, a room, or a word that can mean either ("the stairs").
    Place(Place),
    /// A turn to a side, or around (`Behind`).
    Turn(Side),
    /// Up or down a flight of stairs.
    Climb(Climb),
    /// A numbered floor, the lowest being 1.
    Floor(u32),
}

/// An object or a room in a text.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// Its name in normal spelling.
    pub name: String,
    /// Whether the name can be an object's.
    pub is_thing: bool,
    /// Whether the name can be a room's.
    pub is_room: bool,
    /// How it hangs in its sentence.
    pub link: Link,
    /// The side of the walker on which it is said to be ("on your left").
    pub side: Option<Side>,
    /// The colour that it is said to have.
    pub colour: Option<String>,
    /// It follows a turn that happens at, by or after it ("turn left at the sofa").
    pub tells_turn: bool,
}

/// How a place hangs in its sentence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Link {
    /// No word says so: "leave the kitchen", "the kitchen is on your left".
    Plain,
    /// The walker gets there: "to", "into", "enter".
    Goal,
    /// Something is there, or the walker is: "in", "at", "from", "of".
    Within,
    /// Something lies beside it, and nobody need go there: "next to", "across from", "with".
    Beside,
    /// The walker goes past or through it: "past", "down".
    Along,
}

/// The closing task of an instruction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Task {
    /// Its verb.
    pub verb: String,
    /// The event that is its object, where it names one.
    pub object: Option<usize>,
}

/// Reads a text. `known` holds names, in normal spelling, that the lexicon may lack: those of the evidence.
#[must_use]
pub fn read(text: &str, known: &BTreeSet<String>) -> Reading {
    let tokens = tokens(text);
    let clauses = clauses(&tokens);
    let mut events = turns::turns(&tokens, &clauses);
    events.extend(climbs::climbs_and_floors(&tokens, &clauses));
    let taken: Vec<[usize; 2]> =
        events.iter().filter(|event| matches!(event.what, What::Floor(_))).map(|event| event.span).collect();
    events.extend(places::places(&tokens, &clauses, known, &taken));
    events.sort_by_key(|event| event.span);
    mark_turn_places(&tokens, &mut events);
    let task = task::closing_task(&tokens, &events);
    Reading { events, task }
}

/// The number of the clause that each token stands in. Commas, full stops and "then" begin new ones, and so does an "and"
/// that a verb follows: "the lounge and the bedroom" are in one clause.
fn clauses(tokens: &[Token]) -> Vec<usize> {
    let mut clause = 0;
    let begins = |at: usize, token: &Token| match token.word.as_str() {
        "and" => task::verb_of(tokens, at + 1).is_some(),
        word => !token.is_word() || word == "then",
    };
    let number = |(at, token)| {
        clause += usize::from(begins(at, token));
        clause
    };
    tokens.iter().enumerate().map(number).collect()
}

/// Marks the places that say where the turn before them happens.
fn mark_turn_places(tokens: &[Token], events: &mut [Event]) {
    let connects = |from: usize, to: usize| {
        let between = tokens.iter().filter(|token| token.span[0] >= from && token.span[1] <= to);
        between
            .map(|token| token.word.as_str())
            .any(|word| matches!(word, "at" | "by" | "near" | "after" | "past" | "when" | "once"))
    };
    for at in 1..events.len() {
        let (before, rest) = events.split_at_mut(at);
        let Some(turn) = before.iter().rev().find(|event| !matches!(event.what, What::Place(_))) else { continue };
        let (event, turn_end) = (&mut rest[0], turn.span[1]);
        if let (What::Turn(_), What::Place(place)) = (&turn.what, &mut event.what) {
            place.tells_turn = turn.clause == event.clause && connects(turn_end, event.span[0]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(text: &str) -> Vec<String> {
        let reading = read(text, &BTreeSet::new());
        let word = |event: &Event| match &event.what {
            What::Place(place) => place.name.clone(),
            What::Turn(side) => format!("turn {side:?}"),
            What::Climb(climb) => format!("climb {climb:?}"),
            What::Floor(number) => format!("floor {number}"),
        };
        reading.events.iter().map(word).collect()
    }

    #[test]
    fn an_instruction_is_read_in_order() {
        assert_eq!(
            told(
                "Walk past the dining table, turn left at the large grey couch and go up the stairs. Wait by the sink."
            ),
            ["dining table", "turn Left", "couch", "climb Up", "stair", "sink"]
        );
    }

    #[test]
    fn sides_and_adverbs_are_no_turns() {
        assert_eq!(told("Stop right before the bed on your left."), ["bed"]);
        assert_eq!(told("Take a right, then a left."), ["turn Right", "turn Left"]);
        assert_eq!(told("Turn to your right and head left."), ["turn Right", "turn Left"]);
        assert_eq!(told("The chair to the left of the fireplace"), ["chair", "fireplace"]);
        assert_eq!(told("Turn around and leave."), ["turn Behind"]);
    }

    #[test]
    fn rooms_before_a_thing_belong_to_it() {
        assert_eq!(told("pass the kitchen table"), ["kitchen table"]);
        assert_eq!(told("go to the level 2 bathroom door"), ["floor 2", "door"]);
    }

    #[test]
    fn what_the_lexicon_lacks_is_still_a_landmark() {
        assert_eq!(told("walk to the shiny gizmo and stop"), ["shiny gizmo"]);
        assert_eq!(told("walk all the way to the end"), Vec::<String>::new());
    }

    #[test]
    fn the_closing_task_has_a_verb_and_an_object() {
        let task = |text: &str| read(text, &BTreeSet::new()).task.map(|task| (task.verb, task.object.is_some()));
        assert_eq!(task("Go to the kitchen and wipe the counter"), Some(("wipe".into(), true)));
        assert_eq!(task("Bring me the pillow from the bedroom"), Some(("bring".into(), true)));
        assert_eq!(task("Walk to the kitchen and stop by the sink."), None);
        assert_eq!(task("Clean the sink and go to the bedroom."), None);
        assert_eq!(task("Go to the office with wooden shelves and books"), None);
    }

    #[test]
    fn a_colour_belongs_to_the_thing_behind_it() {
        let colour = |text: &str| match &read(text, &BTreeSet::new()).events[0].what {
            What::Place(place) => place.colour.clone(),
            _ => None,
        };
        assert_eq!(colour("dust the dark grey sofa"), Some("dark grey".into()));
        assert_eq!(colour("dust the gray leather sofa"), Some("grey".into()));
        assert_eq!(colour("dust the old sofa"), None);
    }

    #[test]
    fn walking_on_is_no_task() {
        for style in ["r2r"] {
            for text in crate::style::built_in(style).unwrap().references {
                assert_eq!(read(&text, &BTreeSet::new()).task, None, "{text}");
            }
        }
    }

    #[test]
    fn a_side_belongs_to_the_thing_before_it() {
        let reading = read("clean the lamp on your left", &BTreeSet::new());
        assert!(matches!(&reading.events[0].what, What::Place(place) if place.side == Some(Side::Left)));
        let reading = read("turn left at the sofa", &BTreeSet::new());
        assert!(matches!(&reading.events[1].what, What::Place(place) if place.side.is_none() && place.tells_turn));
    }
}

//! Reads an instruction for the checks: landmarks, rooms, turns, climbs and storeys in the order of the text, and the
//! closing task.
//!
//! The reader does not depend on the author of a text: people's texts, models' texts and those of Wayword's own writer
//! are read in the same way. Each file here reads one kind of statement by closed word lists; the lists are in
//! `languages/en/`.

mod climbs;
mod colours;
mod compass;
mod coverage;
mod denial;
mod distances;
mod events;
#[cfg(test)]
mod growth_tests;
mod links;
pub mod motion_words;
mod numbers;
mod onward;
mod place_motion;
mod places;
pub mod role_words;
mod roles;
mod sides;
mod stems;
pub mod steps;
mod stops;
mod task;
mod tokens;
mod turns;
pub mod vocabulary;

use crate::{
    language::language_of,
    text::{self, TextToken},
};
pub use events::{
    ClosingTask, CompassDirection, EventContent, PlaceLink, PlaceMention, PlaceMotion, PlaceOrdinal, StoreyMention,
    TextEvent, TextReading,
};
pub use numbers::{cardinal_number, ordinal_word};
pub use roles::{ReadWord, TextClause, WordRole};
use std::{collections::BTreeSet, sync::Arc};
use tokens::{ReadTokens, TokenSlice};

/// Reads a text. `known` has the evidence's names in normal spelling, because the lexicon may lack them.
#[must_use]
pub fn read_instruction(text: &str, known: &BTreeSet<String>) -> TextReading {
    let all = text::split_tokens(text);
    let numbers = clause_numbers(&all);
    let tokens = TokenSlice::from_tokens(&all);
    let mut events = turns::read_turns(tokens, &numbers);
    events.extend(climbs::climbs_and_floors(tokens, &numbers));
    events.extend(onward::onward_commands(tokens, &numbers));
    events.extend(compass::compass_events(tokens, &numbers));
    events.extend(stops::stops_and_facing(tokens, &numbers));
    events.extend(distances::read_distances(tokens, &numbers));
    // In "the second floor" there is no place, and "left" in "turn left at the door" is no side of the door.
    let names_no_place =
        |event: &&TextEvent| matches!(event.what, EventContent::Floor(_) | EventContent::Distance { .. });
    let placeless: Vec<[usize; 2]> = events.iter().filter(names_no_place).map(|event| event.span).collect();
    let has_own_side = |event: &&TextEvent| matches!(event.what, EventContent::Turn(_) | EventContent::Floor(_));
    let mut turns_and_storeys: Vec<[usize; 2]> = events.iter().filter(has_own_side).map(|event| event.span).collect();
    turns_and_storeys.sort_unstable();
    events.extend(places::read_places(tokens, &numbers, known, &placeless, &turns_and_storeys));
    events.sort_by_key(|event| event.span);
    let denied = denial::denied_tokens(tokens, &numbers);
    for event in &mut events {
        event.denied = denied[tokens.first_from(event.span[0])];
    }
    mark_turn_places(tokens, &mut events);
    let task = task::closing_task(tokens, &events);
    let (words, clauses) = coverage::read_coverage(tokens, &numbers, &events, known);
    let language = language_of(text, &all, &words);
    let tokens = Arc::new(ReadTokens { all, clauses: numbers, denied });
    TextReading { events, task, words, clauses, language, tokens }
}

/// The number of each token's clause. Commas, full stops and "then" begin a new clause, and so does an "and" before a
/// verb. "The lounge and the bedroom" is in one clause.
#[must_use]
pub fn clause_numbers(tokens: &[TextToken]) -> Vec<usize> {
    let tokens = TokenSlice::from_tokens(tokens);
    let behind_adverbs = task::behind_adverbs(tokens);
    let mut clause = 0;
    let begins = |at: usize| match tokens.word_at(at) {
        "and" => behind_adverbs.get(at + 1).is_some_and(|verb| task::verb_at(tokens, *verb).is_some()),
        word => !tokens.is_word(at) || word == "then",
    };
    let number = |at| {
        clause += usize::from(begins(at));
        clause
    };
    (0..tokens.len()).map(number).collect()
}

/// Marks the places at which the turn before them happens: the sofa of "turn left at the sofa".
fn mark_turn_places(tokens: TokenSlice<'_>, events: &mut [TextEvent]) {
    // A text may have many places, so the connecting words are found once.
    let is_connection =
        |at: &usize| matches!(tokens.word_at(*at), "at" | "by" | "near" | "after" | "past" | "when" | "once");
    let connections: Vec<usize> = (0..tokens.len()).filter(is_connection).collect();
    let connects = |from: usize, to: usize| {
        let (from, to) = (tokens.first_from(from), tokens.first_from(to));
        connections.get(connections.partition_point(|at| *at < from)).is_some_and(|at| *at < to)
    };
    // The clause and the end of the last event that is not a place, if it is a turn.
    let mut turn = None;
    for event in events {
        match (&mut event.what, turn) {
            (EventContent::Place(place), Some((clause, end))) => {
                place.tells_turn = clause == event.clause && connects(end, event.span[0]);
            }
            (EventContent::Place(_), None) => {}
            (EventContent::Turn(_), _) => turn = Some((event.clause, event.span[1])),
            (
                EventContent::Stop
                | EventContent::Face { .. }
                | EventContent::Compass { .. }
                | EventContent::Distance { .. },
                _,
            ) => {}
            _ => turn = None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use wayword_core::Side;

    fn told(text: &str) -> Vec<String> {
        let reading = read_instruction(text, &BTreeSet::new());
        let events =
            reading.events.iter().filter(|event| !matches!(event.what, EventContent::Stop | EventContent::Face { .. }));
        let word = |event: &TextEvent| match &event.what {
            EventContent::Place(place) => place.name.clone(),
            EventContent::Turn(side) => format!("turn {side:?}"),
            EventContent::Climb(climb) => format!("climb {climb:?}"),
            EventContent::Steps(climb) => format!("steps {climb:?}"),
            EventContent::Storey(climb) => format!("storey {climb:?}"),
            EventContent::Floor(floor) => {
                format!("floor {}", floor.number.map_or("top".into(), |number| number.to_string()))
            }
            EventContent::Onward => "on".into(),
            EventContent::Stop
            | EventContent::Face { .. }
            | EventContent::Compass { .. }
            | EventContent::Distance { .. } => String::new(),
        };
        events.map(word).collect()
    }

    proptest! {
        #[test]
        fn any_text_is_read_without_a_panic(
            text in "\\PC{0,80}|((no|not|you|can't|if|too|far|gone|turn|left|right|twice|two|10|ft|steps|few|until|go|up|down|north|east|counter|clockwise|o'clock|at|3|of|the|end|sofa|kitchen|zorble|is|green|on|your|facing|back|to|switch|stop|and|by|from|[,.!])  ?){0,30}",
        ) {
            let reading = read_instruction(&text, &BTreeSet::new());
            let is_part = |[from, to]: [usize; 2]| from < to && text.get(from..to).is_some();
            let tokens = text::split_tokens(&text);
            let spans: Vec<[usize; 2]> = tokens.iter().filter(|token| token.is_word()).map(|token| token.span).collect();
            prop_assert_eq!(reading.words.iter().map(|word| word.span).collect::<Vec<_>>(), spans);
            prop_assert_eq!(reading.tokens(), tokens.as_slice());
            prop_assert_eq!(reading.to_plain_words(), text::split_words(&text));
            prop_assert_eq!(reading.count_sentences(), text::sentence_count(&text));
            for event in &reading.events {
                let clause = reading.clauses[event.clause];
                prop_assert!(is_part(event.span) && clause.span[0] <= event.span[0], "{:?}", event);
            }
            prop_assert!(reading.into_claims().events.iter().all(|event| !event.denied));
        }
    }

    #[test]
    fn an_instruction_is_read_in_order() {
        assert_eq!(
            told(
                "Walk past the dining table, turn left at the large grey couch and go up the stairs. Wait by the sink."
            ),
            ["on", "dining table", "turn Left", "couch", "climb Up", "stair", "sink"]
        );
    }

    #[test]
    fn sides_and_adverbs_are_no_turns() {
        assert_eq!(told("Stop right before the bed on your left."), ["bed"]);
        assert_eq!(told("Take a right, then a left."), ["turn Right", "turn Left"]);
        assert_eq!(told("Turn to your right and head left."), ["turn Right", "turn Left"]);
        assert_eq!(told("The chair to the left of the fireplace"), ["chair", "fireplace"]);
        assert_eq!(told("Turn around and leave."), ["turn Behind"]);
        assert_eq!(told("Make a U-turn at the sofa."), ["turn Behind", "sofa"]);
        assert_eq!(told("Do an about-face."), ["turn Behind"]);
    }

    #[test]
    fn forbidden_actions_are_not_claimed() {
        let claims = |text: &str| {
            let events = read_instruction(text, &BTreeSet::new()).into_claims().events;
            events.iter().filter(|event| event.what != EventContent::Stop).count()
        };
        for text in [
            "Do not turn right.",
            "Don't go up the stairs.",
            "Never enter the kitchen.",
            "Wait without turning left or passing the sofa.",
            "Turn neither left nor right.",
        ] {
            assert_eq!(claims(text), 0, "{text}");
        }
        assert_eq!(claims("Do not turn right but left at the sofa."), 2);
        assert_eq!(claims("Do not stop, turn left."), 1);
        assert_eq!(claims("Don't turn and go to the sofa."), 1);
        let reading =
            read_instruction("Don't pass the sofa. Go to the bed and clean the lamp", &BTreeSet::new()).into_claims();
        let object = reading.task.and_then(|task| task.object).unwrap();
        assert!(matches!(&reading.events[object].what, EventContent::Place(place) if place.name == "lamp"));
    }

    #[test]
    fn into_claims_keeps_the_tokens_of_denied_events() {
        let reading = read_instruction("Do not turn right. Stop at the sofa.", &BTreeSet::new());
        let claims = reading.clone().into_claims();
        assert!(claims.events.len() < reading.events.len());
        assert_eq!(claims.tokens(), reading.tokens());
        assert_eq!(claims.token_clauses(), clause_numbers(reading.tokens()));
    }

    #[test]
    fn rooms_before_a_thing_belong_to_it() {
        assert_eq!(told("pass the kitchen table"), ["kitchen table"]);
        assert_eq!(told("go to the corner bathroom"), ["bathroom"]);
        assert_eq!(told("go to the corner meeting room"), ["meeting room"]);
        assert_eq!(told("go to the level 2 bathroom door"), ["floor 2", "door"]);
        assert_eq!(told("stop once you step into the bathroom"), ["bathroom"]);
    }

    #[test]
    fn a_noun_outside_the_lexicon_is_still_a_landmark() {
        assert_eq!(told("walk to the shiny gizmo and stop"), ["shiny gizmo"]);
        for (text, gizmo) in [
            ("go past that xylorimba", "xylorimba"),
            ("stop at two xylorimbas", "xylorimba"),
            ("wait by my old xylorimba", "old xylorimba"),
            ("stop near their 3 xylorimbas", "3 xylorimba"),
        ] {
            assert_eq!(told(text).last().unwrap(), gizmo);
        }
        for text in [
            "walk all the way to the end",
            "after this enter",
            "stop where this takes you",
            "take two more left turns",
            "wait in the one that says so",
            "turn to your immediate left",
            "stop when on your left soon",
            "at the bottom hang a right",
            "at the top turn left",
        ] {
            let places: Vec<String> = told(text).into_iter().filter(|what| !what.starts_with("turn")).collect();
            assert_eq!(places, Vec::<String>::new(), "{text}");
        }
    }

    #[test]
    fn objects_in_a_picture_are_not_at_the_place() {
        assert_eq!(told("stop at the picture of two hummingbirds"), ["picture"]);
        assert_eq!(told("stop at the bowl of two hummingbirds"), ["bowl", "hummingbird"]);
    }

    #[test]
    fn the_closing_task_has_a_verb_and_an_object() {
        let task =
            |text: &str| read_instruction(text, &BTreeSet::new()).task.map(|task| (task.verb, task.object.is_some()));
        assert_eq!(task("Go to the kitchen and wipe the counter"), Some(("wipe".into(), true)));
        assert_eq!(task("Bring me the pillow from the bedroom"), Some(("bring".into(), true)));
        assert_eq!(task("Walk to the kitchen and stop by the sink."), None);
        assert_eq!(task("Clean the sink and go to the bedroom."), None);
        assert_eq!(task("Go to the office with wooden shelves and books"), None);
    }

    #[test]
    fn a_colour_belongs_to_the_thing_behind_it() {
        let colour = |text: &str| match &read_instruction(text, &BTreeSet::new()).events[0].what {
            EventContent::Place(place) => place.colour.clone(),
            _ => None,
        };
        assert_eq!(colour("dust the dark grey sofa"), Some("dark grey".into()));
        assert_eq!(colour("dust the gray leather sofa"), Some("grey".into()));
        assert_eq!(colour("dust the old sofa"), None);
        assert_eq!(colour("the sofa is green"), Some("green".into()));
        assert_eq!(colour("the doors on your left are dark brown."), Some("dark brown".into()));
        assert_eq!(colour("go to the sofa that is green"), Some("green".into()));
        assert_eq!(colour("the sofa is not green"), None);
        assert_eq!(colour("the sofa is on the green rug"), None);
    }

    #[test]
    fn a_side_belongs_to_the_thing_before_it() {
        let reading = read_instruction("clean the lamp on your left", &BTreeSet::new());
        assert!(matches!(&reading.events[0].what, EventContent::Place(place) if place.side == Some(Side::Left)));
        let reading = read_instruction("turn left at the sofa", &BTreeSet::new());
        assert!(
            matches!(&reading.events[1].what, EventContent::Place(place) if place.side.is_none() && place.tells_turn)
        );
    }
}

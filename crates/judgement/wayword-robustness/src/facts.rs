//! Extracts the statements of a text about its path: landmarks, turns, rooms and floors.

use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use wayword_core::{ClimbDirection, MentionKind, Side, TextMention};
use wayword_language::{
    lexicon::{ThingClass, find_thing, is_room, normalise_name, room_name},
    reading::{EventContent, read_instruction},
};

/// The statements of a text, each kind in the order of the text.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TextFacts {
    /// The landmarks with evidence: the name in normal spelling, and the frame.
    pub landmarks: Vec<(String, usize)>,
    /// The turns. A door or room on a side ("the door on the left") counts as a turn; `Behind` is a turn around.
    pub turns: Vec<Side>,
    /// The rooms with evidence, by their usual names. Equal neighbours count once.
    pub rooms: Vec<String>,
    /// The climbs and the storeys.
    pub floors: Vec<FloorFact>,
}

/// A statement about floors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FloorFact {
    /// One goes up.
    Up,
    /// One goes down.
    Down,
    /// One is on this storey; 0 is the top storey.
    Storey(u32),
}

impl TextFacts {
    /// Extracts the statements. `mentions` are those that the checks have found. `place` maps a frame of the text's own path to the
    /// corresponding frame of the path that both texts are compared on.
    #[must_use]
    pub fn from_mentions(text: &str, mentions: &[TextMention], place: impl Fn(usize) -> usize) -> Self {
        let words = |mention: &TextMention| text.get(mention.span[0]..mention.span[1]).map(normalise_name);
        let of_kind = |kind: MentionKind| mentions.iter().filter(move |mention| mention.kind == kind);
        let landmarks =
            of_kind(MentionKind::Landmark).filter_map(|mention| Some((words(mention)?, place(mention.frame))));
        let usual_name = |name: String| room_name(&name).map_or_else(|| name.clone(), str::to_owned);
        let mut rooms: Vec<String> = of_kind(MentionKind::Room).filter_map(words).map(usual_name).collect();
        rooms.dedup();
        let (mut turns, mut floors) = (Vec::new(), Vec::new());
        for event in read_instruction(text, &BTreeSet::new()).into_claims().events {
            turns.extend(implied_turn(&event.what));
            match event.what {
                EventContent::Climb(climb) | EventContent::Storey(climb) => floors.extend(FloorFact::from_climb(climb)),
                EventContent::Floor(floor) => floors.push(FloorFact::Storey(floor.number.unwrap_or(0))),
                _ => {}
            }
        }
        Self { landmarks: landmarks.collect(), turns, rooms, floors }
    }
}

/// The turn that an event of the text implies: a turn itself, or an opening on a side ("the door on the left").
pub(crate) fn implied_turn(what: &EventContent) -> Option<Side> {
    match what {
        EventContent::Turn(side) => Some(*side),
        EventContent::Place(place) => place.side.filter(|_| goes_through(&place.name)),
        _ => None,
    }
}

/// Names of openings that have no door.
const DOORLESS_OPENINGS: [&str; 4] = ["doorway", "opening", "entrance", "exit"];

/// Whether one walks through or into a thing of this name.
fn goes_through(name: &str) -> bool {
    is_room(name)
        || DOORLESS_OPENINGS.contains(&name)
        || find_thing(name).is_some_and(|thing| thing.class == ThingClass::Door)
}

impl FloorFact {
    /// The statement of a climb; a level way states nothing.
    fn from_climb(climb: ClimbDirection) -> Option<Self> {
        match climb {
            ClimbDirection::Up => Some(Self::Up),
            ClimbDirection::Down => Some(Self::Down),
            ClimbDirection::Level => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_door_on_a_side_is_a_turn() {
        let turns = |text: &str| TextFacts::from_mentions(text, &[], |frame| frame).turns;
        assert_eq!(turns("Take the door on your right and pass the sofa on the left."), [Side::Right]);
        assert_eq!(turns("Enter the bedroom on the left."), [Side::Left]);
    }

    #[test]
    fn a_text_states_landmarks_turns_rooms_and_floors() {
        let text = "Leave the bedroom, turn left at the sofa and go up the stairs. Stop in the bedroom.";
        let mention = |words: &str, kind, frame| {
            let start = text.find(words).unwrap();
            TextMention { span: [start, start + words.len()], kind, frame }
        };
        let mentions = [mention("bedroom", MentionKind::Room, 0), mention("sofa", MentionKind::Landmark, 2)];
        let facts = TextFacts::from_mentions(text, &mentions, |frame| frame * 2);
        assert_eq!(facts.landmarks, [("sofa".to_owned(), 4)]);
        assert_eq!(
            (facts.turns, facts.rooms, facts.floors),
            (vec![Side::Left], vec!["bedroom".to_owned()], vec![FloorFact::Up])
        );
    }
}

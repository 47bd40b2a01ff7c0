//! What a text tells, read back from its words, to compare the texts of a walk in several languages.

use std::collections::BTreeSet;
use wayword_core::{ClimbDirection, Side};
use wayword_language::{
    lexicon::{ThingClass, find_thing, names_agree, room_name, same_room},
    reading::{EventContent, TextReading, read_instruction},
};

/// The sides, climbs and names of a text, each in order.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct TextContent {
    sides: Vec<Side>,
    climbs: Vec<ClimbDirection>,
    names: Vec<String>,
}

impl TextContent {
    /// What is read in English words. Doors, parts of the building and "the room" are left out: they have several words everywhere.
    pub(crate) fn read(english: &str) -> Self {
        let reading: TextReading = read_instruction(english, &BTreeSet::new()).into_claims();
        let mut content = Self { sides: Vec::new(), climbs: Vec::new(), names: Vec::new() };
        for event in &reading.events {
            match &event.what {
                EventContent::Turn(side) => content.sides.push(*side),
                EventContent::Climb(climb) => content.climbs.push(*climb),
                EventContent::Place(place) => {
                    let class = find_thing(&place.name).map(|thing| thing.class);
                    let is_room = room_name(&place.name).is_some_and(|room| room != "stairs");
                    let is_thing = class.is_some_and(|class| {
                        !matches!(class, ThingClass::Fabric | ThingClass::Door | ThingClass::Stairs)
                    });
                    if is_room || is_thing {
                        content.names.push(place.name.clone());
                    }
                }
                _ => {}
            }
        }
        content
    }

    /// Whether it has other sides or climbs than another text, or names a thing that the other text lacks. A name that is not read, such as that
    /// of a room before that of a thing, may still be there.
    pub(crate) fn says_other_than(&self, other: &Self) -> bool {
        let is_known = |name: &String| room_name(name).is_some() || other.names.iter().any(|known| agree(name, known));
        self.sides != other.sides || self.climbs != other.climbs || !self.names.iter().all(is_known)
    }

    /// How much another text differs: in how many places its lists have another entry.
    pub(crate) fn difference(&self, other: &Self) -> usize {
        differing(&self.sides, &other.sides, |a, b| a == b)
            + differing(&self.climbs, &other.climbs, |a, b| a == b)
            + differing(&self.names, &other.names, |a, b| agree(a, b))
    }
}

/// Whether two names may be of one thing or room.
fn agree(one: &str, other: &str) -> bool {
    names_agree(one, other) || same_room(one, other)
}

/// In how many places two lists differ.
fn differing<T>(a: &[T], b: &[T], agree: impl Fn(&T, &T) -> bool) -> usize {
    a.len().abs_diff(b.len()) + a.iter().zip(b).filter(|(a, b)| !agree(a, b)).count()
}

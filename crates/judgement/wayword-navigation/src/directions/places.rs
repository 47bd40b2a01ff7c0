//! The things and rooms that a phrase names, for grounders that look for labels and boxes.

use super::{MAX_READ_BYTES, first_bytes};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use wayword_language::reading::{EventContent, read_instruction};

/// A thing or a room that a phrase names.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct NamedPlace {
    /// Its name: lower case, singular.
    pub name: String,
    /// Whether it names a room and cannot be a thing: true for "kitchen", false for "stairs".
    pub is_room: bool,
}

/// The things and rooms that a phrase names, each once, in the order of the text. Those that the phrase denies are left out.
#[must_use]
pub fn named_places(phrase: &str) -> Vec<NamedPlace> {
    let reading = read_instruction(first_bytes(phrase, MAX_READ_BYTES), &BTreeSet::new()).into_claims();
    let mut names = BTreeSet::new();
    let place = |content: EventContent| match content {
        EventContent::Place(place) => Some(NamedPlace { name: place.name, is_room: place.is_room && !place.is_thing }),
        _ => None,
    };
    let all = reading.events.into_iter().filter_map(|event| place(event.what));
    all.filter(|place| names.insert(place.name.clone())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn things_and_rooms_are_named_once_and_in_order() {
        let told: Vec<(String, bool)> =
            named_places("Past the old sofas in the kitchen to the stairs, not the lamp, by a gizmo and the sofa")
                .into_iter()
                .map(|place| (place.name, place.is_room))
                .collect();
        let wanted = [("sofa", false), ("kitchen", true), ("stair", false), ("gizmo", false)];
        assert_eq!(told, wanted.map(|(name, is_room)| (name.to_owned(), is_room)));
    }

    #[test]
    fn a_room_before_a_thing_is_no_room_to_look_for() {
        let table = NamedPlace { name: "kitchen table".to_owned(), is_room: false };
        assert_eq!(named_places("wipe the kitchen table"), [table]);
        assert_eq!(named_places("turn left"), []);
    }
}

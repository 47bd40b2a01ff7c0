//! Lists the places that a text claims, each with the walker's relation to it.

use super::relation::{WalkerRelation, place_relations};
use wayword_language::{
    lexicon::{ThingClass, find_thing},
    reading::{EventContent, PlaceMention, TextReading},
};

/// A place that a text claims.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaceClaim {
    /// The event of the reading that names it.
    pub event: usize,
    /// Its byte range in the text.
    pub span: [usize; 2],
    /// Its name in normal spelling.
    pub name: String,
    /// Whether the name can be a room's.
    pub is_room: bool,
    /// Whether the name can be an object's.
    pub is_thing: bool,
    /// The class of the object that it can be.
    pub class: ThingClass,
    /// The walker's relation to it.
    pub relation: WalkerRelation,
}

impl PlaceClaim {
    /// The number of its clause.
    #[must_use]
    pub fn clause_in(&self, reading: &TextReading) -> usize {
        reading.events[self.event].clause
    }

    /// Whether the name can only be a room's.
    #[must_use]
    pub fn is_only_room(&self) -> bool {
        self.is_room && !self.is_thing
    }
}

/// The places that a text claims, in its order.
#[must_use]
pub fn read_claims(reading: &TextReading) -> Vec<PlaceClaim> {
    let claim = |event: usize, span: [usize; 2], place: &PlaceMention, relation: WalkerRelation| PlaceClaim {
        event,
        span,
        name: place.name.clone(),
        is_room: place.is_room,
        is_thing: place.is_thing,
        class: find_thing(&place.name).map_or(ThingClass::Unknown, |thing| thing.class),
        relation,
    };
    let events = reading.events.iter().zip(place_relations(reading)).enumerate();
    let places = events.filter_map(|(at, (event, relation))| match &event.what {
        EventContent::Place(place) => Some(claim(at, event.span, place, relation?)),
        _ => None,
    });
    places.collect()
}

//! Lists the places that a text claims, each with the walker's relation to it.

use super::relation::{Relation, relations};
use wayword_language::{
    lexicon::{Class, thing},
    reading::{Place, Reading, What},
};

/// A place that a text claims.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
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
    pub class: Class,
    /// The walker's relation to it.
    pub relation: Relation,
}

impl Claim {
    /// The number of its clause.
    #[must_use]
    pub fn clause(&self, reading: &Reading) -> usize {
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
pub fn claims(reading: &Reading) -> Vec<Claim> {
    let claim = |event: usize, span: [usize; 2], place: &Place, relation: Relation| Claim {
        event,
        span,
        name: place.name.clone(),
        is_room: place.is_room,
        is_thing: place.is_thing,
        class: thing(&place.name).map_or(Class::Unknown, |thing| thing.class),
        relation,
    };
    let events = reading.events.iter().zip(relations(reading)).enumerate();
    let places = events.filter_map(|(at, (event, relation))| match &event.what {
        What::Place(place) => Some(claim(at, event.span, place, relation?)),
        _ => None,
    });
    places.collect()
}

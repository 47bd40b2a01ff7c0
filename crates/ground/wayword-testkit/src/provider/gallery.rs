//! What is to be seen in the pictures that a test shows.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
};

/// A thing in a picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Thing {
    /// Its name.
    pub name: String,
    /// The third of the picture in which it is: 0 left, 1 middle, 2 right.
    pub third: u8,
    /// Its colour.
    pub colour: Option<String>,
}

/// What is to be seen in a picture.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Scenery {
    /// The room.
    pub room: Option<String>,
    /// Things, the nearest first.
    pub things: Vec<Thing>,
}

/// Sceneries by the numbers of their pictures. Clones are the same gallery.
#[derive(Debug, Clone, Default)]
pub struct Gallery(Arc<Mutex<BTreeMap<u64, Scenery>>>);

impl Gallery {
    /// Hangs a picture.
    pub fn hang(&self, id: u64, scenery: Scenery) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).insert(id, scenery);
    }

    /// What is to be seen in a picture.
    #[must_use]
    pub fn scenery(&self, id: u64) -> Option<Scenery> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(&id).cloned()
    }
}

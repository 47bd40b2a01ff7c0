//! The true contents of the pictures in a test: rooms and things, by the number in the picture ([`super::barcode`]). A scripted
//! eye looks them up to answer questions.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
};

/// A thing in a picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GalleryThing {
    /// Its name.
    pub name: String,
    /// The third of the picture that it is in: 0 left, 1 middle, 2 right.
    pub third: u8,
    /// Its colour.
    pub colour: Option<String>,
    /// Whether it is farther than one would call near.
    pub is_far: bool,
}

/// The contents of one picture.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PictureScenery {
    /// The room.
    pub room: Option<String>,
    /// Things, the nearest first.
    pub things: Vec<GalleryThing>,
}

/// The contents of all pictures, by the picture's number. Clones share one gallery.
#[derive(Debug, Clone, Default)]
pub struct PictureGallery(Arc<Mutex<BTreeMap<u64, PictureScenery>>>);

impl PictureGallery {
    /// Adds a picture.
    pub fn add_picture(&self, id: u64, scenery: PictureScenery) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).insert(id, scenery);
    }

    /// The contents of a picture; `None` if it was not added.
    #[must_use]
    pub fn find_scenery(&self, id: u64) -> Option<PictureScenery> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(&id).cloned()
    }
}

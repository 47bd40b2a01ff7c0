//! A grounder that compares the names in a phrase with labels, word by word and with synonyms. It needs no model.

use super::{Sees, labels_of::labels_of};
use crate::directions::{NamedPlace, places};
use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::{Grounder, Label, ModelError, ObjectId, View};
use wayword_language::lexicon::{agree, normal, same_room};

/// The score of a label that means the same by another word ("couch" for a sofa, "chair" for an armchair).
const AKIN: f32 = 0.8;

/// Scores a phrase on a view by the share of the places it names that the view's labels name too, in [0, 1]. A phrase that names
/// none scores 0 everywhere.
pub struct Lexical {
    sees: Sees,
    read: Mutex<BTreeMap<String, Arc<[NamedPlace]>>>,
}

impl Lexical {
    /// A grounder by words.
    #[must_use]
    pub fn new(sees: Sees) -> Self {
        Self { sees, read: Mutex::default() }
    }

    fn places(&self, phrase: &str) -> Arc<[NamedPlace]> {
        if let Some(places) = self.read.lock().unwrap_or_else(PoisonError::into_inner).get(phrase) {
            return Arc::clone(places);
        }
        let read: Arc<[NamedPlace]> = places(phrase).into();
        self.read.lock().unwrap_or_else(PoisonError::into_inner).insert(phrase.to_owned(), Arc::clone(&read));
        read
    }

    fn score(&self, view: &View, places: &[NamedPlace]) -> Result<f32, ModelError> {
        let (labels, room) = labels_of(view, self.name())?;
        let named = |place: &NamedPlace| {
            let by_room = room.filter(|_| self.sees == Sees::Views).map_or(0.0, |room| room_fits(room, place));
            labels.iter().map(|label| fits(&label.name, place)).fold(by_room, f32::max)
        };
        let wanted: Vec<f32> = places.iter().filter(|place| self.holds(place)).map(named).collect();
        Ok(if wanted.is_empty() { 0.0 } else { wanted.iter().sum::<f32>() / wanted.len() as f32 })
    }

    /// Whether a place is of a kind that this grounder can see.
    fn holds(&self, place: &NamedPlace) -> bool {
        self.sees == Sees::Views || !place.is_room
    }
}

fn fits(name: &str, place: &NamedPlace) -> f32 {
    if normal(name) == normal(&place.name) {
        1.0
    } else if agree(name, &place.name) {
        AKIN
    } else {
        0.0
    }
}

fn room_fits(room: &str, place: &NamedPlace) -> f32 {
    if place.is_room && same_room(room, &place.name) { 1.0 } else { 0.0 }
}

impl Grounder for Lexical {
    fn name(&self) -> &str {
        match self.sees {
            Sees::Views => "labels/lexical",
            Sees::Boxes => "labels/lexical/detector",
        }
    }

    fn ground(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<f32>, ModelError>> {
        let places: Vec<Arc<[NamedPlace]>> = phrases.iter().map(|phrase| self.places(phrase)).collect();
        views.iter().map(|view| places.iter().map(|places| self.score(view, places)).collect()).collect()
    }

    /// The nearest of those that fit best.
    fn point(&self, views: &[&View], phrase: &str) -> Result<Option<ObjectId>, ModelError> {
        let places = self.places(phrase);
        let mut best: Option<(f32, f64, &Label)> = None;
        for view in views {
            for label in labels_of(view, self.name())?.0 {
                let fit = places.iter().map(|place| fits(&label.name, place)).fold(0.0, f32::max);
                let near_m = label.distance_m.unwrap_or(f64::INFINITY);
                let is_better = best.is_none_or(|(most, least_m, _)| (fit, -near_m) > (most, -least_m));
                if fit > 0.0 && is_better {
                    best = Some((fit, near_m, label));
                }
            }
        }
        Ok(best.map(|(.., label)| label.object.clone()))
    }
}

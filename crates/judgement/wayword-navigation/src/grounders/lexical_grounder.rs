//! A grounder that compares the names in a phrase with labels, word by word and with synonyms. It needs no model.

use super::{GrounderScope, view_labels::labels_of};
use crate::directions::{NamedPlace, named_places};
use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::{ModelError, ObjectId, ObjectLabel, PhraseGrounder, View};
use wayword_language::lexicon::{names_agree, normalise_name, same_room};

/// The score of a label that means the same by another word ("couch" for a sofa, "chair" for an armchair).
const AKIN_SCORE: f32 = 0.8;

/// Scores a phrase on a view by the share of the places it names that the view's labels name too, in [0, 1]. A phrase that names
/// none scores 0 everywhere.
pub struct LexicalGrounder {
    sees: GrounderScope,
    /// The places that each phrase names, so that a phrase is read once.
    read: Mutex<BTreeMap<String, Arc<[NamedPlace]>>>,
}

impl LexicalGrounder {
    /// A grounder by words.
    #[must_use]
    pub fn new(sees: GrounderScope) -> Self {
        Self { sees, read: Mutex::default() }
    }

    fn places_in_phrase(&self, phrase: &str) -> Arc<[NamedPlace]> {
        if let Some(places) = self.read.lock().unwrap_or_else(PoisonError::into_inner).get(phrase) {
            return Arc::clone(places);
        }
        let read: Arc<[NamedPlace]> = named_places(phrase).into();
        self.read.lock().unwrap_or_else(PoisonError::into_inner).insert(phrase.to_owned(), Arc::clone(&read));
        read
    }

    fn score_view(&self, view: &View, places: &[NamedPlace]) -> Result<f32, ModelError> {
        let (labels, room) = labels_of(view, self.name())?;
        let place_fit = |place: &NamedPlace| {
            let by_room = room.filter(|_| self.sees == GrounderScope::Views).map_or(0.0, |room| room_fits(room, place));
            labels.iter().map(|label| name_fit(&label.name, place)).fold(by_room, f32::max)
        };
        let fits: Vec<f32> = places.iter().filter(|place| self.can_see(place)).map(place_fit).collect();
        Ok(if fits.is_empty() { 0.0 } else { fits.iter().sum::<f32>() / fits.len() as f32 })
    }

    /// Whether a place is of a kind that this grounder can see.
    fn can_see(&self, place: &NamedPlace) -> bool {
        self.sees == GrounderScope::Views || !place.is_room
    }
}

/// How well the name of a label fits a place, in [0, 1].
fn name_fit(name: &str, place: &NamedPlace) -> f32 {
    if normalise_name(name) == normalise_name(&place.name) {
        1.0
    } else if names_agree(name, &place.name) {
        AKIN_SCORE
    } else {
        0.0
    }
}

/// 1 if a view's room is the room that a phrase names, else 0.
fn room_fits(room: &str, place: &NamedPlace) -> f32 {
    if place.is_room && same_room(room, &place.name) { 1.0 } else { 0.0 }
}

impl PhraseGrounder for LexicalGrounder {
    fn name(&self) -> &str {
        match self.sees {
            GrounderScope::Views => "labels/lexical",
            GrounderScope::Boxes => "labels/lexical/detector",
        }
    }

    fn score_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<f32>, ModelError>> {
        let places: Vec<Arc<[NamedPlace]>> = phrases.iter().map(|phrase| self.places_in_phrase(phrase)).collect();
        views.iter().map(|view| places.iter().map(|places| self.score_view(view, places)).collect()).collect()
    }

    /// The object with the label that fits the phrase best; of several, the nearest.
    fn point_to_object(&self, views: &[&View], phrase: &str) -> Result<Option<ObjectId>, ModelError> {
        let places = self.places_in_phrase(phrase);
        let mut best: Option<(f32, f64, &ObjectLabel)> = None;
        for view in views {
            for label in labels_of(view, self.name())?.0 {
                let fit = places.iter().map(|place| name_fit(&label.name, place)).fold(0.0, f32::max);
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

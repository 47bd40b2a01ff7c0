//! A grounder that compares phrases with labels by the vectors of a sentence encoder.

use super::{Sees, labels_of::labels_of};
use crate::directions::places;
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::{Grounder, Label, ModelError, ObjectId, TextEncoder, View};

type Vector = Arc<[f32]>;

/// Scores a phrase on a view by the label that is most similar to it: the cosine of an encoder's vectors. A view without labels
/// scores 0.
///
/// For views it takes the whole phrase; for boxes the mean over the places that the phrase names, because a detector
/// looks for each noun by itself.
pub struct Similar {
    sees: Sees,
    encoder: Arc<dyn TextEncoder>,
    vectors: Mutex<BTreeMap<String, Vector>>,
}

impl Similar {
    /// A grounder by an encoder.
    #[must_use]
    pub fn new(sees: Sees, encoder: Arc<dyn TextEncoder>) -> Self {
        Self { sees, encoder, vectors: Mutex::default() }
    }

    /// The parts of a phrase that are compared with labels: the whole phrase, or its places one by one.
    fn parts(&self, phrase: &str) -> Vec<String> {
        let named: Vec<String> = match self.sees {
            Sees::Views => Vec::new(),
            Sees::Boxes => places(phrase).into_iter().filter(|place| !place.is_room).map(|place| place.name).collect(),
        };
        if named.is_empty() { vec![phrase.to_owned()] } else { named }
    }

    /// The vectors of texts, each encoded once for all views.
    fn vectors(&self, texts: &BTreeSet<&str>) -> Result<BTreeMap<String, Vector>, ModelError> {
        let known = self.vectors.lock().unwrap_or_else(PoisonError::into_inner);
        let mut found: BTreeMap<String, Vector> =
            texts.iter().filter_map(|text| Some(((*text).to_owned(), Arc::clone(known.get(*text)?)))).collect();
        drop(known);
        let missing: Vec<&str> = texts.iter().filter(|text| !found.contains_key(**text)).copied().collect();
        if missing.is_empty() {
            return Ok(found);
        }
        // Encoded without the lock, so that other threads do not wait.
        let computed = self.encoder.encode(&missing)?;
        let mut known = self.vectors.lock().unwrap_or_else(PoisonError::into_inner);
        for (text, vector) in missing.into_iter().zip(computed) {
            let vector: Vector = vector.into();
            known.insert(text.to_owned(), Arc::clone(&vector));
            found.insert(text.to_owned(), vector);
        }
        Ok(found)
    }

    /// The names that a view shows.
    fn names<'v>(&self, view: &'v View) -> Result<Vec<&'v str>, ModelError> {
        let (labels, room) = labels_of(view, self.name())?;
        let room = room.filter(|_| self.sees == Sees::Views);
        Ok(labels.iter().map(|label| label.name.as_str()).chain(room).collect())
    }
}

fn cosine(vectors: &BTreeMap<String, Vector>, a: &str, b: &str) -> f32 {
    let (Some(a), Some(b)) = (vectors.get(a), vectors.get(b)) else { return 0.0 };
    a.iter().zip(b.iter()).map(|(a, b)| a * b).sum()
}

/// How alike a phrase's parts are to the names, at least 0.
fn score(vectors: &BTreeMap<String, Vector>, parts: &[String], names: &[&str]) -> f32 {
    let best = |part: &String| names.iter().map(|name| cosine(vectors, part, name)).fold(0.0, f32::max);
    parts.iter().map(best).sum::<f32>() / parts.len().max(1) as f32
}

impl Grounder for Similar {
    fn name(&self) -> &str {
        match self.sees {
            Sees::Views => "labels",
            Sees::Boxes => "labels/detector",
        }
    }

    fn ground(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<f32>, ModelError>> {
        let parts: Vec<Vec<String>> = phrases.iter().map(|phrase| self.parts(phrase)).collect();
        let names: Vec<Result<Vec<&str>, ModelError>> = views.iter().map(|view| self.names(view)).collect();
        let texts = names.iter().flatten().flatten().copied().chain(parts.iter().flatten().map(String::as_str));
        let vectors = self.vectors(&texts.collect());
        let of_view = |names: Result<Vec<&str>, ModelError>| {
            let (names, vectors) = (names?, vectors.as_ref().map_err(Clone::clone)?);
            Ok(parts.iter().map(|parts| score(vectors, parts, &names)).collect())
        };
        names.into_iter().map(of_view).collect()
    }

    fn point(&self, views: &[&View], phrase: &str) -> Result<Option<ObjectId>, ModelError> {
        let parts = self.parts(phrase);
        let mut labels: Vec<&Label> = Vec::new();
        for view in views {
            labels.extend(labels_of(view, self.name())?.0);
        }
        let texts = labels.iter().map(|label| label.name.as_str()).chain(parts.iter().map(String::as_str));
        let vectors = self.vectors(&texts.collect())?;
        let fit = |label: &Label| score(&vectors, &parts, &[&label.name]);
        let near_m = |label: &Label| label.distance_m.unwrap_or(f64::INFINITY);
        // Of those that fit equally well, the nearest.
        let best =
            labels.into_iter().max_by(|a, b| fit(a).total_cmp(&fit(b)).then_with(|| near_m(b).total_cmp(&near_m(a))));
        Ok(best.map(|label| label.object.clone()))
    }
}

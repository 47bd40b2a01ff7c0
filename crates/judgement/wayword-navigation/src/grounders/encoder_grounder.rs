//! A grounder that compares phrases with labels by the vectors of a sentence encoder.

use super::{GrounderScope, view_labels::labels_of};
use crate::directions::named_places;
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::{ModelError, ObjectId, ObjectLabel, PhraseGrounder, TextEncoder, View};

/// The vector of a text, of length 1.
type TextVector = Arc<[f32]>;

/// Scores a phrase on a view by the label that is most similar to it: the cosine of an encoder's vectors. A view without labels
/// scores 0.
///
/// For views it takes the whole phrase; for boxes the mean over the places that the phrase names, because a detector
/// looks for each noun by itself.
pub struct EncoderGrounder {
    sees: GrounderScope,
    encoder: Arc<dyn TextEncoder>,
    /// The vectors of all texts that were encoded so far.
    vectors: Mutex<BTreeMap<String, TextVector>>,
}

impl EncoderGrounder {
    /// A grounder by an encoder.
    #[must_use]
    pub fn new(sees: GrounderScope, encoder: Arc<dyn TextEncoder>) -> Self {
        Self { sees, encoder, vectors: Mutex::default() }
    }

    /// The parts of a phrase that are compared with labels: the whole phrase, or its places one by one.
    fn phrase_parts(&self, phrase: &str) -> Vec<String> {
        let named: Vec<String> = match self.sees {
            GrounderScope::Views => Vec::new(),
            GrounderScope::Boxes => {
                named_places(phrase).into_iter().filter(|place| !place.is_room).map(|place| place.name).collect()
            }
        };
        if named.is_empty() { vec![phrase.to_owned()] } else { named }
    }

    /// The vectors of texts, each encoded once for all views.
    fn text_vectors(&self, texts: &BTreeSet<&str>) -> Result<BTreeMap<String, TextVector>, ModelError> {
        let known = self.vectors.lock().unwrap_or_else(PoisonError::into_inner);
        let mut found: BTreeMap<String, TextVector> =
            texts.iter().filter_map(|text| Some(((*text).to_owned(), Arc::clone(known.get(*text)?)))).collect();
        drop(known);
        let missing: Vec<&str> = texts.iter().filter(|text| !found.contains_key(**text)).copied().collect();
        if missing.is_empty() {
            return Ok(found);
        }
        // Encoded without the lock, so that other threads do not wait.
        let computed = self.encoder.encode_texts(&missing)?;
        let mut known = self.vectors.lock().unwrap_or_else(PoisonError::into_inner);
        for (text, vector) in missing.into_iter().zip(computed) {
            let vector: TextVector = vector.into();
            known.insert(text.to_owned(), Arc::clone(&vector));
            found.insert(text.to_owned(), vector);
        }
        Ok(found)
    }

    /// The names that a view shows.
    fn view_names<'v>(&self, view: &'v View) -> Result<Vec<&'v str>, ModelError> {
        let (labels, room) = labels_of(view, self.name())?;
        let room = room.filter(|_| self.sees == GrounderScope::Views);
        Ok(labels.iter().map(|label| label.name.as_str()).chain(room).collect())
    }
}

/// The cosine of the vectors of two texts; 0 if one has none.
fn cosine(vectors: &BTreeMap<String, TextVector>, a: &str, b: &str) -> f32 {
    let (Some(a), Some(b)) = (vectors.get(a), vectors.get(b)) else { return 0.0 };
    a.iter().zip(b.iter()).map(|(a, b)| a * b).sum()
}

/// How alike a phrase's parts are to the names, at least 0.
fn score_names(vectors: &BTreeMap<String, TextVector>, parts: &[String], names: &[&str]) -> f32 {
    let best = |part: &String| names.iter().map(|name| cosine(vectors, part, name)).fold(0.0, f32::max);
    parts.iter().map(best).sum::<f32>() / parts.len().max(1) as f32
}

impl PhraseGrounder for EncoderGrounder {
    fn name(&self) -> &str {
        match self.sees {
            GrounderScope::Views => "labels",
            GrounderScope::Boxes => "labels/detector",
        }
    }

    fn score_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<f32>, ModelError>> {
        let parts: Vec<Vec<String>> = phrases.iter().map(|phrase| self.phrase_parts(phrase)).collect();
        let names: Vec<Result<Vec<&str>, ModelError>> = views.iter().map(|view| self.view_names(view)).collect();
        let texts = names.iter().flatten().flatten().copied().chain(parts.iter().flatten().map(String::as_str));
        let vectors = self.text_vectors(&texts.collect());
        let view_scores = |names: Result<Vec<&str>, ModelError>| {
            let (names, vectors) = (names?, vectors.as_ref().map_err(Clone::clone)?);
            Ok(parts.iter().map(|parts| score_names(vectors, parts, &names)).collect())
        };
        names.into_iter().map(view_scores).collect()
    }

    fn point_to_object(&self, views: &[&View], phrase: &str) -> Result<Option<ObjectId>, ModelError> {
        let parts = self.phrase_parts(phrase);
        let mut labels: Vec<&ObjectLabel> = Vec::new();
        for view in views {
            labels.extend(labels_of(view, self.name())?.0);
        }
        let texts = labels.iter().map(|label| label.name.as_str()).chain(parts.iter().map(String::as_str));
        let vectors = self.text_vectors(&texts.collect())?;
        let fit = |label: &ObjectLabel| score_names(&vectors, &parts, &[&label.name]);
        let near_m = |label: &ObjectLabel| label.distance_m.unwrap_or(f64::INFINITY);
        // Of those that fit equally well, the nearest.
        let best =
            labels.into_iter().max_by(|a, b| fit(a).total_cmp(&fit(b)).then_with(|| near_m(b).total_cmp(&near_m(a))));
        Ok(best.map(|label| label.object.clone()))
    }
}

//! CLIP as a grounder: it scores how well phrases fit views.

use super::ClipModel;
use crate::{
    LocalError,
    picture::{picture_digest, picture_of_view},
};
use sha2::{Digest, Sha256};
use std::{collections::BTreeMap, sync::Arc};
use wayword_core::{Image, ModelError, PhraseGrounder, RecentCache, View};

/// The hash of the picture or the text that a vector belongs to.
type GrounderKey = [u8; 32];

/// The most vectors of pictures that are kept, and as many of texts: about 50 MB each.
const MAX_KEPT_VECTORS: usize = 16 << 10;

/// Scores a phrase on a view by the cosine of their vectors, between -1 and 1.
///
/// CLIP's `logit_scale` is left out, because it only matters if scores become probabilities. A phrase is used as it is:
/// the caller may add "a photo of ..". The vectors of recent pictures and phrases are kept by their content.
pub struct ClipGrounder {
    clip: ClipModel,
    images: RecentCache<GrounderKey, Vec<f32>>,
    texts: RecentCache<GrounderKey, Vec<f32>>,
}

impl ClipGrounder {
    /// A grounder that uses this CLIP.
    #[must_use]
    pub fn new(clip: ClipModel) -> Self {
        Self { clip, images: RecentCache::new(MAX_KEPT_VECTORS), texts: RecentCache::new(MAX_KEPT_VECTORS) }
    }

    /// Whether the model reads a phrase to its end. The end of a phrase that is too long is cut off.
    ///
    /// # Errors
    /// When the phrase cannot be made into tokens.
    pub fn reads_whole_phrase(&self, phrase: &str) -> Result<bool, ModelError> {
        self.clip.reads_whole_text(phrase).map_err(|error| self.to_model_error(&error))
    }

    fn to_model_error(&self, error: &LocalError) -> ModelError {
        ModelError::Failed { model: self.clip.name().to_owned(), reason: error.to_string() }
    }
}

impl PhraseGrounder for ClipGrounder {
    fn name(&self) -> &str {
        self.clip.name()
    }

    fn score_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<f32>, ModelError>> {
        let images: Vec<Result<&Image, ModelError>> =
            views.iter().map(|view| picture_of_view(view, self.clip.name())).collect();
        let pictures: Vec<&Image> = images.iter().filter_map(|image| image.as_ref().ok().copied()).collect();
        let vectors =
            cached_vectors(&self.images, &pictures, picture_digest, |images| self.clip.image_features(images))
                .and_then(|pictures| {
                    let texts = |texts: &[&str]| self.clip.text_features(texts);
                    Ok((pictures, cached_vectors(&self.texts, phrases, |text| Sha256::digest(text).into(), texts)?))
                })
                .map_err(|error| self.to_model_error(&error));
        // Views without a picture have an error in `images`, and no vector.
        let mut at = 0;
        let scores = |image: Result<&Image, ModelError>| {
            image?;
            at += 1;
            let (pictures, texts) = vectors.as_ref().map_err(Clone::clone)?;
            Ok(texts.iter().map(|text| dot_product(&pictures[at - 1], text)).collect())
        };
        images.into_iter().map(scores).collect()
    }
}

/// The vectors of pictures or texts, in their order. Recent vectors are reused, and each of the others is computed
/// once, even if the same thing is there several times.
fn cached_vectors<T: Copy>(
    recent: &RecentCache<GrounderKey, Vec<f32>>,
    things: &[T],
    key: impl Fn(T) -> GrounderKey,
    compute: impl Fn(&[T]) -> Result<Vec<Vec<f32>>, LocalError>,
) -> Result<Vec<Arc<Vec<f32>>>, LocalError> {
    let keys: Vec<GrounderKey> = things.iter().map(|&thing| key(thing)).collect();
    let mut known: BTreeMap<GrounderKey, Arc<Vec<f32>>> = BTreeMap::new();
    let mut missing: BTreeMap<GrounderKey, T> = BTreeMap::new();
    for (key, &thing) in keys.iter().zip(things) {
        match recent.get(key) {
            Some(vector) => drop(known.insert(*key, vector)),
            None => drop(missing.insert(*key, thing)),
        }
    }
    let computed = compute(&missing.values().copied().collect::<Vec<T>>())?;
    known.extend(missing.into_keys().zip(computed).map(|(key, vector)| (key, recent.put(key, vector))));
    Ok(keys.iter().filter_map(|key| known.get(key).cloned()).collect())
}

fn dot_product(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

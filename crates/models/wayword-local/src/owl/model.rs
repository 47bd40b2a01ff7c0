//! A whole OWLv2 as an [`ObjectDetector`]: from a picture and phrases to boxes with scores.

use super::{
    FEATURE_CACHE_BYTES,
    boxes::boxes_from_logits,
    heads::{BoxHead, ClassHead, PatchClasses, unit_vectors},
    picture::OwlPictureProcessor,
};
use crate::{
    LocalError, ModelDevice, WeightPrecision,
    clip::{TextTower, TowerFamily, TowersConfig, VisionTower},
    ops::{LayerNorm, LinearLayer},
    picture::{picture_digest, picture_of_view},
    tokenizer::TextTokenizer,
    weights::CheckpointWeights,
};
use candle_core::{Result as Computed, Tensor};
use std::{path::Path, sync::Arc};
use wayword_core::{DetectedBox, DetectorScoring, Image, ModelError, ObjectDetector, RecentCache, View};

/// The number of texts that are computed together.
const TEXTS_PER_BATCH: usize = 32;

/// The most texts for which vectors are kept, about 2 kB each.
const MAX_KEPT_TEXTS: usize = 4 << 10;

/// OWLv2. The features of recent pictures are kept, in at most 256 MiB, and the vectors of recent texts.
pub struct OwlDetector {
    name: String,
    processor: OwlPictureProcessor,
    tokenizer: TextTokenizer,
    vision: VisionTower,
    text: TextTower,
    text_projection: LinearLayer,
    patch_norm: LayerNorm,
    classes: ClassHead,
    boxes: BoxHead,
    /// The width and height to which pictures are resized, pixels.
    edge: usize,
    /// The most tokens of a text.
    longest: usize,
    device: ModelDevice,
    /// The features of recent pictures, by the hash of the picture.
    picture_cache: RecentCache<[u8; 32], OwlPictureFeatures>,
    /// The unit vectors of recent texts.
    text_cache: RecentCache<String, Tensor>,
}

/// The features of a picture: classes and boxes of its patches. They do not depend on the texts.
struct OwlPictureFeatures {
    classes: PatchClasses,
    /// Centre, width and height, as shares of the square's edge.
    boxes: Vec<[f32; 4]>,
}

/// The network's own numbers for a picture and texts, for comparisons with other implementations.
#[derive(Debug, Clone)]
pub struct OwlOutputs {
    /// For each text the logit of each patch, rows from the top.
    pub logits: Vec<Vec<f32>>,
    /// The box of each patch: centre, width and height, as shares of the longer edge of the picture.
    pub boxes: Vec<[f32; 4]>,
}

impl OwlDetector {
    /// Reads `config.json`, `preprocessor_config.json`, `tokenizer.json` and the checkpoint of a folder. `name` is the
    /// model's name: `hf/ORG/NAME`.
    ///
    /// # Errors
    /// When a file is missing or damaged, or the checkpoint has another architecture.
    pub fn load(
        name: &str,
        folder: &Path,
        device: &ModelDevice,
        precision: WeightPrecision,
    ) -> Result<Self, LocalError> {
        let config = TowersConfig::from_folder(folder, TowerFamily::Owl)?;
        let (vision, text) = (&config.vision, &config.text);
        let (vision_width, text_width) = (vision.layers.hidden_size, text.layers.hidden_size);
        if config.projection_dim != text_width {
            return Err(LocalError::File {
                file: folder.join("config.json"),
                problem: format!(
                    "projection_dim: {} is not text_config.hidden_size, {text_width}",
                    config.projection_dim
                ),
                hint: "choose an OWLv2 model, such as hf/google/owlv2-base-patch16-ensemble",
            });
        }
        let processor = OwlPictureProcessor::load(folder, vision.image_size)?;
        let tokenizer = TextTokenizer::load(folder)?;
        let weights = CheckpointWeights::open(folder, device, precision)?;
        let (all, side) = (weights.scope_under(""), vision.image_size / vision.patch_size);
        // Each patch has a class vector, a shift and a scale, and the four numbers of a box.
        let picture_bytes = side * side * (text_width + 6) * size_of::<f32>();
        Ok(Self {
            name: name.to_owned(),
            processor,
            tokenizer,
            vision: VisionTower::from_weights(&weights.scope_under("owlv2.vision_model"), vision, "pre_layernorm")?,
            text: TextTower::from_weights(&weights.scope_under("owlv2.text_model"), text)?,
            text_projection: all.read_linear("owlv2.text_projection", text_width, text_width)?,
            patch_norm: all.read_layer_norm("layer_norm", vision_width, vision.layers.layer_norm_eps)?,
            classes: ClassHead::from_weights(&weights.scope_under("class_head"), vision_width, text_width)?,
            boxes: BoxHead::from_weights(&weights.scope_under("box_head"), vision_width, side, &device.0)?,
            edge: vision.image_size,
            longest: text.max_position_embeddings,
            device: device.clone(),
            picture_cache: RecentCache::one_at_a_time((FEATURE_CACHE_BYTES / picture_bytes.max(1)).max(1)),
            text_cache: RecentCache::new(MAX_KEPT_TEXTS),
        })
    }

    /// The width and height to which pictures are resized, pixels.
    #[must_use]
    pub fn edge_px(&self) -> usize {
        self.edge
    }

    /// The network's numbers for a picture and texts, which are used as they are.
    ///
    /// # Errors
    /// When the picture has no pixels, or the computation fails.
    pub fn raw_outputs(&self, image: &Image, texts: &[&str]) -> Result<OwlOutputs, LocalError> {
        let features = self.picture_features(image)?;
        Ok(OwlOutputs { logits: self.text_logits(&features, texts)?, boxes: features.boxes.clone() })
    }

    /// Finds phrases in a picture: for each phrase its boxes, the best first.
    ///
    /// # Errors
    /// When the picture has no pixels, or the computation fails.
    pub fn find_phrases(&self, image: &Image, phrases: &[&str]) -> Result<Vec<Vec<DetectedBox>>, LocalError> {
        let features = self.picture_features(image)?;
        let texts: Vec<String> = phrases.iter().map(|phrase| photo_prompt(phrase)).collect();
        let logits = self.text_logits(&features, &texts.iter().map(String::as_str).collect::<Vec<_>>())?;
        let size = (image.width_px(), image.height_px());
        Ok(logits.iter().map(|logits| boxes_from_logits(logits, &features.boxes, size)).collect())
    }

    /// For each text the logit of each patch.
    fn text_logits(&self, features: &OwlPictureFeatures, texts: &[&str]) -> Result<Vec<Vec<f32>>, LocalError> {
        if texts.is_empty() {
            return Ok(Vec::new());
        }
        let cached = self.text_vectors(texts)?;
        let vectors: Vec<&Tensor> = cached.iter().map(|vector| &**vector).collect();
        let logits = Tensor::stack(&vectors, 0).and_then(|texts| features.classes.text_logits(&texts));
        logits.map_err(|error| LocalError::compute_failed(&self.name, &error))
    }

    /// The features of a picture: kept ones, or else new ones, which are then kept.
    fn picture_features(&self, image: &Image) -> Result<Arc<OwlPictureFeatures>, LocalError> {
        self.picture_cache.get_or_make(picture_digest(image), || {
            let picture = self.processor.to_tensor(image, &self.device)?;
            self.compute_features(&picture).map_err(|error| LocalError::compute_failed(&self.name, &error))
        })
    }

    fn compute_features(&self, picture: &Tensor) -> Computed<OwlPictureFeatures> {
        let states = self.vision.encode_all_tokens(picture)?;
        let (class, patches) = (states.narrow(1, 0, 1)?, states.narrow(1, 1, states.dim(1)? - 1)?);
        let patches = self.patch_norm.apply_to(&patches.broadcast_mul(&class)?)?;
        Ok(OwlPictureFeatures {
            classes: self.classes.classify_patches(&patches)?,
            boxes: self.boxes.predict_boxes(&patches)?,
        })
    }

    /// The unit vectors of texts, in their order: kept ones, or else new ones. Texts of similar length are computed
    /// together.
    fn text_vectors(&self, texts: &[&str]) -> Result<Vec<Arc<Tensor>>, LocalError> {
        let mut known: Vec<Option<Arc<Tensor>>> =
            texts.iter().map(|&text| self.text_cache.get(&text.to_owned())).collect();
        let mut missing: Vec<(usize, Vec<u32>)> = Vec::new();
        for (at, text) in texts.iter().enumerate().filter(|(at, _)| known[*at].is_none()) {
            missing.push((at, self.tokenizer.text_ids(text, self.longest)?));
        }
        missing.sort_by_key(|(_, ids)| ids.len());
        for batch in missing.chunks(TEXTS_PER_BATCH) {
            let ids: Vec<&[u32]> = batch.iter().map(|(_, ids)| &ids[..]).collect();
            let vectors = self.compute_vectors(&ids).map_err(|error| LocalError::compute_failed(&self.name, &error))?;
            for ((at, _), vector) in batch.iter().zip(vectors) {
                known[*at] = Some(self.text_cache.put(texts[*at].to_owned(), vector));
            }
        }
        Ok(known.into_iter().flatten().collect())
    }

    fn compute_vectors(&self, ids: &[&[u32]]) -> Computed<Vec<Tensor>> {
        let states = self.text.encode_texts(ids, &self.device.0)?;
        // transformers scales to length 1 twice.
        let vectors = unit_vectors(&unit_vectors(&self.text_projection.apply_to(&states)?.squeeze(1)?)?)?;
        (0..ids.len()).map(|at| vectors.get(at)).collect()
    }
}

/// The text for a phrase, as the documentation of the checkpoints recommends: "a photo of a sink". If the phrase has an
/// article, it is left out.
fn photo_prompt(phrase: &str) -> String {
    let phrase = phrase.trim();
    let article = |(first, _): &(&str, &str)| ["a", "an", "the"].iter().any(|word| first.eq_ignore_ascii_case(word));
    let thing = phrase.split_once(char::is_whitespace).filter(article).map_or(phrase, |(_, rest)| rest.trim_start());
    format!("a photo of a {thing}")
}

impl ObjectDetector for OwlDetector {
    fn name(&self) -> &str {
        &self.name
    }

    fn scoring(&self) -> DetectorScoring {
        DetectorScoring {
            means: "OWLv2: the sigmoid of the best patch's logit for \"a photo of a PHRASE\", each phrase by itself",
            find_threshold: 0.1,
            phrases_interact: false,
        }
    }

    fn detect_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<Vec<DetectedBox>>, ModelError>> {
        let detect_one = |view: &&View| {
            let image = picture_of_view(view, &self.name)?;
            let failed = |error: LocalError| ModelError::Failed { model: self.name.clone(), reason: error.to_string() };
            self.find_phrases(image, phrases).map_err(failed)
        };
        views.iter().map(detect_one).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::photo_prompt;

    #[test]
    fn a_phrase_is_put_into_the_documented_prompt_without_its_own_article() {
        for (phrase, text) in [
            ("sink", "a photo of a sink"),
            ("the kitchen sink", "a photo of a kitchen sink"),
            ("An  oven ", "a photo of a oven"),
            ("a", "a photo of a a"),
            ("theatre seat", "a photo of a theatre seat"),
        ] {
            assert_eq!(photo_prompt(phrase), text);
        }
    }
}

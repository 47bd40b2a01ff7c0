//! A whole GLIP as an [`ObjectDetector`]: from a picture and phrases to boxes with scores.

use super::{
    GlipFiles,
    boxes::{GlipPictureSizes, phrase_boxes},
    config::GlipConfig,
    head::GlipLevelOutputs,
    model::GlipModel,
    prompt::{GlipPrompt, MAX_PROMPT_TOKENS, build_prompts},
};
use crate::{
    LocalError, ModelDevice, WeightPrecision,
    ops::conv3::FeatureMap,
    picture::{PaddedPictureProcessor, picture_digest, picture_of_view},
    tokenizer::TextTokenizer,
    weights::CheckpointWeights,
};
use candle_core::{Result as Computed, Tensor};
use std::path::Path;
use wayword_core::{DetectedBox, DetectorScoring, Image, ModelError, ObjectDetector, RecentCache, View};

/// The most memory for the features of recent pictures, bytes. The oldest are dropped beyond this.
pub(crate) const FEATURE_CACHE_BYTES: usize = 512 << 20;

/// Means and standard deviations of the bytes of blue, green and red.
const BYTE_MEANS_BGR: [f32; 3] = [103.53, 116.28, 123.675];
const BYTE_DEVIATIONS_BGR: [f32; 3] = [57.375, 57.12, 58.395];

/// The longest edge of a picture for the model, pixels.
const LONG_EDGE_PX: usize = 1333;

/// GLIP. The score of a box is the root of the phrase's probability times the box's centreness, as in the original.
/// Boxes with a probability of 0.05 or less are left out.
///
/// The features of pictures are kept, in at most 512 MiB of memory, so that further phrases only cost the time of the
/// head.
pub struct GlipDetector {
    name: String,
    model: GlipModel,
    tokenizer: TextTokenizer,
    /// Resizes and pads pictures, and turns them into tensors.
    processor: PaddedPictureProcessor,
    /// The most tokens of a prompt.
    most_tokens: usize,
    device: ModelDevice,
    /// The features of recent pictures, by the hash of the picture.
    picture_cache: RecentCache<[u8; 32], GlipFeatures>,
}

/// A picture's features, and its width and height as the model sees it, pixels.
struct GlipFeatures {
    levels: Vec<FeatureMap>,
    size: (usize, usize),
}

impl GlipDetector {
    /// The usual short edge of a picture for the model, pixels.
    pub const SHORT_EDGE_PX: usize = 800;

    /// Reads a checkpoint. `name` is the model's name. A shorter edge is faster and finds less.
    ///
    /// # Errors
    /// When a file is missing or damaged, or the checkpoint has another architecture.
    pub fn load(
        name: &str,
        files: &GlipFiles,
        short_edge_px: usize,
        device: &ModelDevice,
        precision: WeightPrecision,
    ) -> Result<Self, LocalError> {
        let config = GlipConfig::from_folder(files.weights.parent().unwrap_or(Path::new(".")))?;
        let edges = PaddedPictureProcessor::new(
            short_edge_px,
            LONG_EDGE_PX,
            // Edges are padded to multiples of the backbone's largest stride. The channels are blue, green, red.
            32,
            [2, 1, 0],
            BYTE_MEANS_BGR,
            BYTE_DEVIATIONS_BGR,
        )?;
        let tokenizer = TextTokenizer::load(&files.tokenizer)?;
        let most_words = config.text.vocab_size();
        if tokenizer.vocabulary_size() > most_words {
            return Err(LocalError::File {
                file: files.tokenizer.join("tokenizer.json"),
                problem: format!("it has {} words, but the model knows {most_words}", tokenizer.vocabulary_size()),
                hint: "GLIP needs the tokenizer of bert-base-uncased",
            });
        }
        let weights = CheckpointWeights::open_file(&files.weights, device, precision)?;
        let model = GlipModel::from_weights(&weights, &config)?;
        let picture_count = (FEATURE_CACHE_BYTES / model.feature_bytes(edges.max_pixels()).max(1)).max(1);
        Ok(Self {
            name: name.to_owned(),
            model,
            tokenizer,
            processor: edges,
            most_tokens: MAX_PROMPT_TOKENS.min(config.text.max_positions()),
            device: device.clone(),
            picture_cache: RecentCache::one_at_a_time(picture_count),
        })
    }

    /// The head's outputs for a picture and one prompt of phrases: for each position of all levels, the logits of the
    /// tokens, and five numbers of its box. For comparisons with other implementations.
    ///
    /// # Errors
    /// When the phrases are too many for one prompt, or the computation fails.
    pub fn raw_outputs(&self, image: &Image, phrases: &[&str]) -> Result<(Vec<f32>, Vec<f32>), LocalError> {
        let prompts = build_prompts(&self.tokenizer, phrases, self.most_tokens)?;
        let [prompt] = &prompts[..] else { return Err(self.input_error("these phrases are not one prompt")) };
        let features = self.picture_features(image)?;
        let outputs = self.head_outputs(&features, prompt)?;
        let logits = outputs.iter().flat_map(|outputs| outputs.logits.iter().copied()).collect();
        Ok((logits, outputs.iter().flat_map(|outputs| outputs.boxes.iter().copied()).collect()))
    }

    /// Finds phrases in a picture: for each phrase its boxes, the best first.
    ///
    /// # Errors
    /// When a phrase is too long, the picture has no pixels, or the computation fails.
    pub fn find_phrases(&self, image: &Image, phrases: &[&str]) -> Result<Vec<Vec<DetectedBox>>, LocalError> {
        let prompts = build_prompts(&self.tokenizer, phrases, self.most_tokens)?;
        let texts = self.encode_prompts(&prompts)?;
        self.find_all(image, phrases.len(), &prompts, &texts)
    }

    /// Finds phrases, which are already in prompts, in a picture: for each phrase its boxes.
    fn find_all(
        &self,
        image: &Image,
        phrases: usize,
        prompts: &[GlipPrompt],
        texts: &[Tensor],
    ) -> Result<Vec<Vec<DetectedBox>>, LocalError> {
        let mut found = vec![Vec::new(); phrases];
        if prompts.is_empty() {
            return Ok(found);
        }
        let features = self.picture_features(image)?;
        let sizes =
            GlipPictureSizes { shown: features.size, picture: (image.width_px() as usize, image.height_px() as usize) };
        for (prompt, text) in prompts.iter().zip(texts) {
            let outputs =
                self.model.head_outputs(&features.levels, text).map_err(|error| self.compute_error(&error))?;
            for ((number, _), boxes) in prompt.phrases.iter().zip(phrase_boxes(&outputs, prompt, sizes)) {
                found[*number] = boxes;
            }
        }
        Ok(found)
    }

    fn head_outputs(&self, features: &GlipFeatures, prompt: &GlipPrompt) -> Result<Vec<GlipLevelOutputs>, LocalError> {
        let texts = self.encode_prompts(std::slice::from_ref(prompt))?;
        let text = texts.first().ok_or_else(|| self.input_error("there is no prompt"))?;
        self.model.head_outputs(&features.levels, text).map_err(|error| self.compute_error(&error))
    }

    /// The states of the tokens of prompts.
    fn encode_prompts(&self, prompts: &[GlipPrompt]) -> Result<Vec<Tensor>, LocalError> {
        let states = prompts.iter().map(|prompt| self.model.text_states(&prompt.ids, &self.device.0));
        states.collect::<Computed<_>>().map_err(|error| self.compute_error(&error))
    }

    /// The features of a picture: kept ones, or else new ones, which are then kept.
    fn picture_features(&self, image: &Image) -> Result<std::sync::Arc<GlipFeatures>, LocalError> {
        self.picture_cache.get_or_make(picture_digest(image), || {
            let (pixels, size) = self.processor.to_tensor(image, &self.device)?;
            let levels = self.model.feature_levels(&pixels).map_err(|error| self.compute_error(&error))?;
            Ok(GlipFeatures { levels, size })
        })
    }

    fn compute_error(&self, error: &candle_core::Error) -> LocalError {
        LocalError::compute_failed(&self.name, error)
    }

    fn input_error(&self, problem: &str) -> LocalError {
        LocalError::Compute { model: self.name.clone(), problem: problem.to_owned() }
    }
}

impl ObjectDetector for GlipDetector {
    fn name(&self) -> &str {
        &self.name
    }

    fn scoring(&self) -> DetectorScoring {
        DetectorScoring {
            means: "GLIP's: root of (mean probability of the phrase's tokens times centreness), phrases joined by \". \" into one prompt",
            find_threshold: 0.5,
            phrases_interact: true,
        }
    }

    fn detect_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<Vec<DetectedBox>>, ModelError>> {
        let failed = |error: LocalError| ModelError::Failed { model: self.name.clone(), reason: error.to_string() };
        let encode = || {
            let prompts = build_prompts(&self.tokenizer, phrases, self.most_tokens)?;
            let texts = self.encode_prompts(&prompts)?;
            Ok((prompts, texts))
        };
        let encoded = encode().map_err(failed);
        let detect_one = |view: &&View| {
            let image = picture_of_view(view, &self.name)?;
            let (prompts, texts) = encoded.as_ref().map_err(Clone::clone)?;
            self.find_all(image, phrases.len(), prompts, texts).map_err(failed)
        };
        views.iter().map(detect_one).collect()
    }
}

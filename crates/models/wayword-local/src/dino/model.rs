//! A whole model of the Grounding DINO family: from a picture and a prompt to the scores and boxes of its queries.

use super::{
    config::{DinoConfig, DinoFamily},
    decoder::{DinoDecoder, DinoPredictions},
    encoder::EncoderLayer,
    features::{DinoFeatureExtractor, PictureFeatures},
    picture::DinoPictureProcessor,
    prompt::{self, DinoPrompt},
    queries::QueryChooser,
    text::{PromptStates, TextTower},
};
use crate::{
    LocalError, ModelDevice, WeightPrecision, picture::picture_digest, tokenizer::TextTokenizer,
    weights::CheckpointWeights,
};
use candle_core::{DType, Result as Computed, Tensor};
use std::{path::Path, sync::Arc};
use wayword_core::{Image, RecentCache};

/// The memory that the features of recent pictures may take, bytes. The oldest are dropped beyond this.
pub(crate) const FEATURE_CACHE_BYTES: usize = 256 << 20;

/// The edge of the patches into which the backbone cuts a picture, pixels.
const PATCH_PX: usize = 4;

/// MM Grounding DINO, LLMDet or Grounding DINO: finds things in pictures by phrases.
///
/// The features of a picture do not depend on the phrases. They are computed once, and kept for recent pictures in at
/// most 256 MiB.
pub struct GroundingDino {
    pub(super) name: String,
    pub(super) family: DinoFamily,
    /// Resizes pictures and turns them into tensors.
    processor: DinoPictureProcessor,
    tokenizer: TextTokenizer,
    /// Computes the features of pictures.
    extractor: DinoFeatureExtractor,
    /// Computes the states of prompts.
    reader: TextTower,
    encoder: Vec<EncoderLayer>,
    chooser: QueryChooser,
    decoder: DinoDecoder,
    /// The most tokens of a prompt.
    longest: usize,
    device: ModelDevice,
    /// The features of recent pictures, by the hash of the picture.
    picture_cache: RecentCache<[u8; 32], PictureFeatures>,
}

/// The network's own numbers for a picture and a prompt, for comparisons with other implementations.
#[derive(Debug, Clone)]
pub struct DinoOutputs {
    /// The best candidate cells, the best first, whether or not they became queries.
    pub picked: Vec<u32>,
    /// For each query the logit of each token.
    pub logits: Vec<Vec<f32>>,
    /// The box of each query: middle, width and height, as shares of the picture's width and height.
    pub boxes: Vec<[f32; 4]>,
}

impl GroundingDino {
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
        let config = DinoConfig::from_folder(folder)?;
        let shown = DinoPictureProcessor::load(folder)?;
        let tokenizer = TextTokenizer::load(folder)?;
        let weights = CheckpointWeights::open(folder, device, precision)?;
        let (all, model) = (weights.scope_under(""), weights.scope_under("model"));
        let layer = |at: usize| EncoderLayer::from_weights(&model.sub_scope("encoder.layers").sub_scope(at), &config);
        // The bytes of one picture: the cells of the finest level, and a quarter as many for each coarser one.
        let cell_px = PATCH_PX << config.backbone.outputs.first().copied().unwrap_or_default();
        let picture_bytes = (shown.max_pixels() / (cell_px * cell_px) + 1) * 4 / 3 * config.size * size_of::<f32>();
        Ok(Self {
            name: name.to_owned(),
            family: config.family,
            processor: shown,
            tokenizer,
            extractor: DinoFeatureExtractor::from_weights(&model, &config)?,
            reader: TextTower::from_weights(&model, &config)?,
            encoder: (0..config.encoder.count).map(layer).collect::<Result<_, _>>()?,
            chooser: QueryChooser::from_weights(&model, &config)?,
            decoder: DinoDecoder::from_weights(&all, &config)?,
            longest: config.longest,
            device: device.clone(),
            picture_cache: RecentCache::new((FEATURE_CACHE_BYTES / picture_bytes).max(1)),
        })
    }

    /// Puts phrases into prompts, and computes the states of their texts.
    pub(super) fn encode_prompts(&self, phrases: &[&str]) -> Result<Vec<(DinoPrompt, PromptStates)>, LocalError> {
        let encode = |prompt: DinoPrompt| {
            let text = self.reader.encode_prompt(&prompt, &self.device.0);
            text.map(|text| (prompt, text)).map_err(|error| self.compute_error(&error))
        };
        prompt::build_prompts(&self.name, &self.tokenizer, phrases, self.longest)?.into_iter().map(encode).collect()
    }

    /// The features of a picture: kept ones, or else new ones, which are then kept.
    pub(super) fn picture_features(&self, image: &Image) -> Result<Arc<PictureFeatures>, LocalError> {
        self.picture_cache.get_or_make(picture_digest(image), || {
            let pixels = self.processor.to_tensor(image, &self.device)?;
            self.extractor.extract_features(&pixels).map_err(|error| self.compute_error(&error))
        })
    }

    /// The scores and boxes of the queries, for one prompt and one picture.
    pub(super) fn predict_boxes(
        &self,
        features: &PictureFeatures,
        text: &PromptStates,
    ) -> Result<DinoPredictions, LocalError> {
        self.predict_with_candidates(features, text, |best| best).map_err(|error| self.compute_error(&error))
    }

    /// Like [`GroundingDino::predict_boxes`], but `choose` may replace the best candidates, or reorder them. The order
    /// matters: each query begins with its own learned state, so that two equal candidates that change places change
    /// the result.
    pub(super) fn predict_with_candidates(
        &self,
        features: &PictureFeatures,
        text: &PromptStates,
        choose: impl FnOnce(Vec<u32>) -> Vec<u32>,
    ) -> Computed<DinoPredictions> {
        let (cells, tokens) = self.encode_states(features, text)?;
        let levels = &features.levels[..];
        let candidates = self.chooser.score_candidates(&cells, &tokens, levels)?;
        let picked = choose(self.chooser.best_candidates(&candidates));
        self.decoder.refine_boxes(self.chooser.candidate_boxes(&candidates, &picked)?, &cells, &tokens, levels)
    }

    /// The states of cells and tokens after the encoder.
    pub(super) fn encode_states(&self, features: &PictureFeatures, text: &PromptStates) -> Computed<(Tensor, Tensor)> {
        let levels = &features.levels[..];
        let positions = self.extractor.cell_positions(levels)?;
        let begin = (features.cells.clone(), text.states.clone());
        self.encoder
            .iter()
            .try_fold(begin, |(cells, states), layer| layer.apply_to(&cells, &states, (&positions, levels), text))
    }

    /// The network's own numbers for a picture and phrases of one prompt. `order` replaces the best candidates by
    /// others: these cells become the queries, in this order.
    ///
    /// # Errors
    /// When the phrases are too many for one prompt, or the computation fails.
    pub fn raw_outputs(
        &self,
        image: &Image,
        phrases: &[&str],
        order: Option<&[u32]>,
    ) -> Result<DinoOutputs, LocalError> {
        let prompts = self.encode_prompts(phrases)?;
        let [(_, text)] = &prompts[..] else {
            let problem = "these phrases are not one prompt".to_owned();
            return Err(LocalError::Compute { model: self.name.clone(), problem });
        };
        let features = self.picture_features(image)?;
        let mut picked = Vec::new();
        let predictions = self.predict_with_candidates(&features, text, |best| {
            picked.clone_from(&best);
            order.map_or(best, <[u32]>::to_vec)
        });
        let numbers = predictions
            .and_then(|predictions| Ok((predictions.logits.to_dtype(DType::F32)?.to_vec2()?, predictions.boxes)));
        let (logits, boxes) = numbers.map_err(|error| self.compute_error(&error))?;
        Ok(DinoOutputs { picked, logits, boxes })
    }

    fn compute_error(&self, error: &candle_core::Error) -> LocalError {
        LocalError::compute_failed(&self.name, error)
    }
}

/// Intermediate results, for tests.
#[cfg(test)]
impl GroundingDino {
    pub(super) fn pixels(&self, image: &Image) -> Tensor {
        self.processor.to_tensor(image, &self.device).unwrap()
    }

    pub(super) fn candidates(&self, features: &PictureFeatures, text: &PromptStates) -> Computed<Vec<f32>> {
        let (cells, read) = self.encode_states(features, text)?;
        Ok(self.chooser.score_candidates(&cells, &read, &features.levels)?.scores)
    }
}

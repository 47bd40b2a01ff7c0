//! BLIP's checkpoint that answers questions about pictures (visual question answering).

use super::{
    config::BlipConfig,
    decoder::BlipDecoder,
    text::{BlipKeysValues, TextModel},
    vision::BlipVision,
};
use crate::{
    LocalError, ModelDevice, WeightPrecision,
    picture::{PictureProcessor, picture_digest},
    tokenizer::TextTokenizer,
    weights::CheckpointWeights,
};
use candle_core::{DType, Tensor};
use std::path::Path;
use wayword_core::{Image, RecentCache};

/// The most pictures for which keys and values are kept, about 45 MB each; the oldest is dropped. A frame gets about
/// ten questions, so recomputing these numbers for each question would waste most of the time.
const MAX_KEPT_PICTURES: usize = 4;

/// A BLIP that answers questions about pictures. An encoder reads the question and attends to the picture, and a
/// decoder answers from the encoder's states.
pub struct BlipVqa {
    name: String,
    processor: PictureProcessor,
    tokenizer: TextTokenizer,
    vision: BlipVision,
    encoder: TextModel,
    pub(super) decoder: BlipDecoder,
    /// The most tokens of a question.
    longest: usize,
    /// Keys and values of recent pictures, by the hash of the picture.
    picture_cache: RecentCache<[u8; 32], BlipKeysValues>,
    device: ModelDevice,
}

impl BlipVqa {
    /// Reads a folder with `config.json`, `preprocessor_config.json`, `tokenizer.json` and the checkpoint. `name` is
    /// the model's name: `hf/ORG/NAME`.
    ///
    /// # Errors
    /// When a file is missing or damaged, or the checkpoint has another architecture.
    pub fn load(
        name: &str,
        folder: &Path,
        device: &ModelDevice,
        precision: WeightPrecision,
    ) -> Result<Self, LocalError> {
        let config = BlipConfig::from_folder(folder)?;
        let weights = CheckpointWeights::open(folder, device, precision)?;
        Ok(Self {
            name: name.to_owned(),
            processor: PictureProcessor::load(folder)?,
            tokenizer: TextTokenizer::load(folder)?,
            vision: BlipVision::from_weights(&weights.scope_under("vision_model"), &config.vision_config)?,
            encoder: TextModel::from_weights(&weights.scope_under("text_encoder"), &config.text_config)?,
            decoder: BlipDecoder::from_weights(&weights.scope_under("text_decoder"), &config.text_config)?,
            longest: config.text_config.max_position_embeddings,
            picture_cache: RecentCache::one_at_a_time(MAX_KEPT_PICTURES),
            device: device.clone(),
        })
    }

    /// The answer to a question, of at most `most_tokens` tokens. The vision model runs once for all questions about a
    /// picture.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn answer_question(&self, picture: &Image, question: &str, most_tokens: usize) -> Result<String, LocalError> {
        let states = self.encode_question(picture, question)?;
        let tokens = self
            .decoder
            .text
            .cross_keys_values(&states)
            .and_then(|attended| self.decoder.generate_tokens(&[], &attended, most_tokens, &self.device.0));
        self.tokenizer.decode_ids(&tokens.map_err(|error| LocalError::compute_failed(&self.name, &error))?)
    }

    /// The encoder's states of a question and a picture, [tokens, size] row by row.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn question_states(&self, picture: &Image, question: &str) -> Result<Vec<f32>, LocalError> {
        let states = self.encode_question(picture, question)?;
        let states = states.flatten_all().and_then(|states| states.to_dtype(DType::F32)?.to_vec1());
        states.map_err(|error| LocalError::compute_failed(&self.name, &error))
    }

    /// The encoder's states of a question and a picture, [1, tokens, size].
    pub(super) fn encode_question(&self, picture: &Image, question: &str) -> Result<Tensor, LocalError> {
        let to_local_error = |error: candle_core::Error| LocalError::compute_failed(&self.name, &error);
        let keys_values = self.picture_cache.get_or_make(picture_digest(picture), || {
            let pixels = self.processor.to_tensor(&[picture], &self.device)?;
            self.vision
                .encode_pictures(&pixels)
                .and_then(|states| self.encoder.cross_keys_values(&states))
                .map_err(to_local_error)
        })?;
        let ids = self.tokenizer.text_ids(question, self.longest)?;
        let encoded = Tensor::new(&ids[..], &self.device.0)
            .and_then(|ids| self.encoder.encode_text(&ids.unsqueeze(0)?, &keys_values));
        encoded.map_err(to_local_error)
    }
}

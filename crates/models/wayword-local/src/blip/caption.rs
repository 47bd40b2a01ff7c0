//! BLIP's checkpoint that describes pictures.

use super::{config::BlipConfig, decoder::BlipDecoder, vision::BlipVision};
use crate::{
    LocalError, ModelDevice, WeightPrecision, picture::PictureProcessor, tokenizer::TextTokenizer,
    weights::CheckpointWeights,
};
use candle_core::DType;
use std::path::Path;
use wayword_core::Image;

/// A BLIP that describes pictures.
pub struct BlipCaptioner {
    name: String,
    pub(super) processor: PictureProcessor,
    tokenizer: TextTokenizer,
    pub(super) vision: BlipVision,
    pub(super) decoder: BlipDecoder,
    pub(super) device: ModelDevice,
}

impl BlipCaptioner {
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
            decoder: BlipDecoder::from_weights(&weights.scope_under("text_decoder"), &config.text_config)?,
            device: device.clone(),
        })
    }

    /// A description that begins with `beginning` and continues with at most `most_tokens` tokens.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn describe_picture(&self, picture: &Image, beginning: &str, most_tokens: usize) -> Result<String, LocalError> {
        self.tokenizer.decode_ids(&self.description_tokens(picture, beginning, most_tokens)?)
    }

    /// The tokens of a description, without the ones that begin and end it.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn description_tokens(
        &self,
        picture: &Image,
        beginning: &str,
        most_tokens: usize,
    ) -> Result<Vec<u32>, LocalError> {
        let prompt = self.tokenizer.inner_ids(beginning)?;
        let pixels = self.processor.to_tensor(&[picture], &self.device)?;
        let continuation = self.vision.encode_pictures(&pixels).and_then(|states| {
            let attended = self.decoder.text.cross_keys_values(&states)?;
            self.decoder.generate_tokens(&prompt, &attended, most_tokens, &self.device.0)
        });
        let continuation = continuation.map_err(|error| LocalError::compute_failed(&self.name, &error))?;
        Ok([prompt, continuation].concat())
    }

    /// The vision model's states of a picture, [patches + 1, size] row by row.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn picture_states(&self, picture: &Image) -> Result<Vec<f32>, LocalError> {
        let pixels = self.processor.to_tensor(&[picture], &self.device)?;
        let states = self
            .vision
            .encode_pictures(&pixels)
            .and_then(|states| states.flatten_all()?.to_dtype(DType::F32)?.to_vec1());
        states.map_err(|error| LocalError::compute_failed(&self.name, &error))
    }
}

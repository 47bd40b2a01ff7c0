//! BLIP's checkpoint that describes pictures.

use super::{config::Config, decoder::Decoder, vision::Vision};
use crate::{Device, LocalError, Precision, picture::Processor, text::Tokenizer, weights::Weights};
use candle_core::DType;
use std::path::Path;
use wayword_core::Image;

/// A BLIP that describes pictures.
pub struct BlipCaptioner {
    name: String,
    pub(super) processor: Processor,
    tokenizer: Tokenizer,
    pub(super) vision: Vision,
    pub(super) decoder: Decoder,
    pub(super) device: Device,
}

impl BlipCaptioner {
    /// Reads a folder with `config.json`, `preprocessor_config.json`, `tokenizer.json` and the checkpoint. `name` is
    /// the model's name: `hf/ORG/NAME`.
    ///
    /// # Errors
    /// When a file is missing or damaged, or the checkpoint has another architecture.
    pub fn load(name: &str, folder: &Path, device: &Device, precision: Precision) -> Result<Self, LocalError> {
        let config = Config::read(folder)?;
        let weights = Weights::open(folder, device, precision)?;
        Ok(Self {
            name: name.to_owned(),
            processor: Processor::load(folder)?,
            tokenizer: Tokenizer::load(folder)?,
            vision: Vision::load(&weights.scope("vision_model"), &config.vision_config)?,
            decoder: Decoder::load(&weights.scope("text_decoder"), &config.text_config)?,
            device: device.clone(),
        })
    }

    /// A description that begins with `beginning` and continues with at most `most_tokens` tokens.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn caption(&self, picture: &Image, beginning: &str, most_tokens: usize) -> Result<String, LocalError> {
        self.tokenizer.text(&self.tokens(picture, beginning, most_tokens)?)
    }

    /// The tokens of a description, without the ones that begin and end it.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn tokens(&self, picture: &Image, beginning: &str, most_tokens: usize) -> Result<Vec<u32>, LocalError> {
        let prompt = self.tokenizer.inner_ids(beginning)?;
        let pixels = self.processor.tensor(&[picture], &self.device)?;
        let said = self.vision.of(&pixels).and_then(|states| {
            let attended = self.decoder.text.attended(&states)?;
            self.decoder.speak(&prompt, &attended, most_tokens, &self.device.0)
        });
        let said = said.map_err(|error| LocalError::compute(&self.name, &error))?;
        Ok([prompt, said].concat())
    }

    /// The vision model's states of a picture, [patches + 1, size] row by row.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn states(&self, picture: &Image) -> Result<Vec<f32>, LocalError> {
        let pixels = self.processor.tensor(&[picture], &self.device)?;
        let states = self.vision.of(&pixels).and_then(|states| states.flatten_all()?.to_dtype(DType::F32)?.to_vec1());
        states.map_err(|error| LocalError::compute(&self.name, &error))
    }
}

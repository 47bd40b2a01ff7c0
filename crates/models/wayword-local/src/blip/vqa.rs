//! BLIP's checkpoint that answers questions about pictures (visual question answering).

use super::{
    config::Config,
    decoder::Decoder,
    text::{Attended, TextModel},
    vision::Vision,
};
use crate::{
    Device, LocalError, Precision,
    picture::{Processor, digest},
    text::Tokenizer,
    weights::Weights,
};
use candle_core::{DType, Tensor};
use std::path::Path;
use wayword_core::{Image, Recent};

/// The number of pictures for which keys and values are kept, about 45 MB each. A frame gets about ten questions, so
/// recomputing them would waste most of the time.
const KEPT: usize = 4;

/// A BLIP that answers questions about pictures. An encoder reads the question and attends to the picture, and a
/// decoder answers from the encoder's states.
pub struct BlipVqa {
    name: String,
    processor: Processor,
    tokenizer: Tokenizer,
    vision: Vision,
    encoder: TextModel,
    pub(super) decoder: Decoder,
    longest: usize,
    seen: Recent<[u8; 32], Attended>,
    device: Device,
}

impl BlipVqa {
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
            encoder: TextModel::load(&weights.scope("text_encoder"), &config.text_config)?,
            decoder: Decoder::load(&weights.scope("text_decoder"), &config.text_config)?,
            longest: config.text_config.max_position_embeddings,
            seen: Recent::one_at_a_time(KEPT),
            device: device.clone(),
        })
    }

    /// The answer to a question, of at most `most_tokens` tokens. The vision model runs once for all questions about a
    /// picture.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn answer(&self, picture: &Image, question: &str, most_tokens: usize) -> Result<String, LocalError> {
        let said = self.read(picture, question)?;
        let said = self
            .decoder
            .text
            .attended(&said)
            .and_then(|attended| self.decoder.speak(&[], &attended, most_tokens, &self.device.0));
        self.tokenizer.text(&said.map_err(|error| LocalError::compute(&self.name, &error))?)
    }

    /// The encoder's states of a question and a picture, [tokens, size] row by row.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn states(&self, picture: &Image, question: &str) -> Result<Vec<f32>, LocalError> {
        let states = self.read(picture, question)?;
        let states = states.flatten_all().and_then(|states| states.to_dtype(DType::F32)?.to_vec1());
        states.map_err(|error| LocalError::compute(&self.name, &error))
    }

    pub(super) fn read(&self, picture: &Image, question: &str) -> Result<Tensor, LocalError> {
        let compute = |error: candle_core::Error| LocalError::compute(&self.name, &error);
        let seen = self.seen.get_or_make(digest(picture), || {
            let pixels = self.processor.tensor(&[picture], &self.device)?;
            self.vision.of(&pixels).and_then(|states| self.encoder.attended(&states)).map_err(compute)
        })?;
        let ids = self.tokenizer.ids(question, self.longest)?;
        let read = Tensor::new(&ids[..], &self.device.0).and_then(|ids| self.encoder.read(&ids.unsqueeze(0)?, &seen));
        read.map_err(compute)
    }
}

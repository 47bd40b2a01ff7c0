//! BLIP-2 (arXiv 2301.12597), as in transformers' `Blip2ForConditionalGeneration`. A Q-Former condenses the states of a
//! vision model to a few tokens. They come before the prompt, and a language model continues the text.

mod config;
mod opt;
mod qformer;
mod t5;

use crate::{
    Device, LocalError, Precision,
    blip::Vision,
    ops::Linear,
    picture::{Processor, digest},
    text::Tokenizer,
    weights::Weights,
};
use candle_core::{DType, Tensor};
use config::{Config, TextConfig};
use opt::Opt;
use qformer::QFormer;
use std::path::Path;
use t5::T5;
use wayword_core::{Image, Recent};

/// The number of pictures for which the condensed tokens are kept, because a frame gets about ten questions.
const KEPT: usize = 4;

/// A BLIP-2: answers questions about pictures, and continues texts about them.
pub struct Blip2 {
    name: String,
    processor: Processor,
    tokenizer: Tokenizer,
    vision: Vision,
    queries: QFormer,
    projection: Linear,
    speaker: Speaker,
    seen: Recent<[u8; 32], Tensor>,
    device: Device,
}

/// The language model that writes the answer.
enum Speaker {
    T5(Box<T5>),
    Opt(Box<Opt>),
}

/// The most tokens of a prompt.
const LONGEST_PROMPT: usize = 512;

impl Blip2 {
    /// Reads a folder with `config.json`, `preprocessor_config.json`, `tokenizer.json` and the checkpoint. `name` is
    /// the model's name: `hf/ORG/NAME`.
    ///
    /// # Errors
    /// When a file is missing or damaged, or the checkpoint has another architecture.
    pub fn load(name: &str, folder: &Path, device: &Device, precision: Precision) -> Result<Self, LocalError> {
        let config = Config::read(folder)?;
        let weights = Weights::open(folder, device, precision)?;
        let all = weights.scope("");
        let speaker = match &config.text_config {
            TextConfig::T5(text) => Speaker::T5(Box::new(T5::load(&weights.scope("language_model"), text)?)),
            TextConfig::Opt(text) => Speaker::Opt(Box::new(Opt::load(&weights.scope("language_model"), text)?)),
        };
        let width = config.text_config.width();
        Ok(Self {
            name: name.to_owned(),
            processor: Processor::load(folder)?,
            tokenizer: Tokenizer::load(folder)?,
            vision: Vision::load(&weights.scope("vision_model"), &config.vision_config.blip())?,
            queries: QFormer::load(&all, &config.qformer_config, config.num_query_tokens)?,
            projection: all.linear("language_projection", config.qformer_config.hidden_size, width)?,
            speaker,
            seen: Recent::one_at_a_time(KEPT),
            device: device.clone(),
        })
    }

    /// The text that follows a picture and a prompt, of at most `most_tokens` tokens. The vision model runs once for
    /// all prompts about a picture.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn answer(&self, picture: &Image, prompt: &str, most_tokens: usize) -> Result<String, LocalError> {
        self.tokenizer.text(&self.tokens(picture, prompt, most_tokens)?)
    }

    /// The tokens of that text.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn tokens(&self, picture: &Image, prompt: &str, most_tokens: usize) -> Result<Vec<u32>, LocalError> {
        let seen = self.seen.get_or_make(digest(picture), || self.see(picture))?;
        let ids = self.tokenizer.ids(prompt, LONGEST_PROMPT)?;
        let said = Tensor::new(&ids[..], &self.device.0).and_then(|ids| match &self.speaker {
            Speaker::T5(t5) => t5.speak(&seen, &ids.unsqueeze(0)?, most_tokens),
            Speaker::Opt(opt) => opt.speak(&seen, &ids.unsqueeze(0)?, most_tokens),
        });
        said.map_err(|error| LocalError::compute(&self.name, &error))
    }

    /// The condensed states of a picture, [queries, width] row by row, as the language model gets them.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn queries(&self, picture: &Image) -> Result<Vec<f32>, LocalError> {
        let seen = self.see(picture)?;
        let numbers = seen.flatten_all().and_then(|seen| seen.to_dtype(DType::F32)?.to_vec1());
        numbers.map_err(|error| LocalError::compute(&self.name, &error))
    }

    fn see(&self, picture: &Image) -> Result<Tensor, LocalError> {
        let pixels = self.processor.tensor(&[picture], &self.device)?;
        let seen = self.vision.of(&pixels).and_then(|states| self.projection.of(&self.queries.of(&states)?));
        seen.map_err(|error| LocalError::compute(&self.name, &error))
    }
}

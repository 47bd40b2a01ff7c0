//! BLIP-2 (arXiv 2301.12597), as in transformers' `Blip2ForConditionalGeneration`. A Q-Former condenses the states of a
//! vision model to a few tokens. They come before the prompt, and a language model continues the text.

mod config;
mod opt;
mod qformer;
mod t5;

use crate::{
    LocalError, ModelDevice, WeightPrecision,
    blip::BlipVision,
    ops::LinearLayer,
    picture::{PictureProcessor, picture_digest},
    tokenizer::TextTokenizer,
    weights::CheckpointWeights,
};
use candle_core::{DType, Tensor};
use config::{Blip2Config, TextConfig};
use opt::OptModel;
use qformer::QFormer;
use std::path::Path;
use t5::T5Model;
use wayword_core::{Image, RecentCache};

/// The most pictures for which the condensed tokens are kept, because a frame gets about ten questions. The oldest is
/// dropped.
const MAX_KEPT_PICTURES: usize = 4;

/// A BLIP-2: answers questions about pictures, and continues texts about them.
pub struct Blip2Model {
    name: String,
    processor: PictureProcessor,
    tokenizer: TextTokenizer,
    vision: BlipVision,
    queries: QFormer,
    /// Brings the Q-Former's states to the width of the language model.
    projection: LinearLayer,
    /// The model that writes the answer.
    language_model: Blip2LanguageModel,
    /// The condensed tokens of recent pictures, by the hash of the picture.
    picture_cache: RecentCache<[u8; 32], Tensor>,
    device: ModelDevice,
}

/// The language models that checkpoints of BLIP-2 come with: FlanT5 or OPT.
enum Blip2LanguageModel {
    T5(Box<T5Model>),
    Opt(Box<OptModel>),
}

/// The most tokens of a prompt. The rest is cut off.
const MAX_PROMPT_TOKENS: usize = 512;

impl Blip2Model {
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
        let config = Blip2Config::from_folder(folder)?;
        let weights = CheckpointWeights::open(folder, device, precision)?;
        let all = weights.scope_under("");
        let speaker = match &config.text_config {
            TextConfig::T5(text) => {
                Blip2LanguageModel::T5(Box::new(T5Model::from_weights(&weights.scope_under("language_model"), text)?))
            }
            TextConfig::Opt(text) => {
                Blip2LanguageModel::Opt(Box::new(OptModel::from_weights(&weights.scope_under("language_model"), text)?))
            }
        };
        let width = config.text_config.state_width();
        Ok(Self {
            name: name.to_owned(),
            processor: PictureProcessor::load(folder)?,
            tokenizer: TextTokenizer::load(folder)?,
            vision: BlipVision::from_weights(
                &weights.scope_under("vision_model"),
                &config.vision_config.to_blip_config(),
            )?,
            queries: QFormer::from_weights(&all, &config.qformer_config, config.num_query_tokens)?,
            projection: all.read_linear("language_projection", config.qformer_config.hidden_size, width)?,
            language_model: speaker,
            picture_cache: RecentCache::one_at_a_time(MAX_KEPT_PICTURES),
            device: device.clone(),
        })
    }

    /// The text that follows a picture and a prompt, of at most `most_tokens` tokens. The vision model runs once for
    /// all prompts about a picture.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn continue_prompt(&self, picture: &Image, prompt: &str, most_tokens: usize) -> Result<String, LocalError> {
        self.tokenizer.decode_ids(&self.answer_tokens(picture, prompt, most_tokens)?)
    }

    /// The tokens of the text that [`Blip2Model::continue_prompt`] returns.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn answer_tokens(&self, picture: &Image, prompt: &str, most_tokens: usize) -> Result<Vec<u32>, LocalError> {
        let picture_tokens =
            self.picture_cache.get_or_make(picture_digest(picture), || self.encode_picture(picture))?;
        let ids = self.tokenizer.text_ids(prompt, MAX_PROMPT_TOKENS)?;
        let tokens = Tensor::new(&ids[..], &self.device.0).and_then(|ids| match &self.language_model {
            Blip2LanguageModel::T5(t5) => t5.generate_tokens(&picture_tokens, &ids.unsqueeze(0)?, most_tokens),
            Blip2LanguageModel::Opt(opt) => opt.generate_tokens(&picture_tokens, &ids.unsqueeze(0)?, most_tokens),
        });
        tokens.map_err(|error| LocalError::compute_failed(&self.name, &error))
    }

    /// The condensed states of a picture, [queries, width] row by row, as the language model gets them.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn query_states(&self, picture: &Image) -> Result<Vec<f32>, LocalError> {
        let states = self.encode_picture(picture)?;
        let numbers = states.flatten_all().and_then(|states| states.to_dtype(DType::F32)?.to_vec1());
        numbers.map_err(|error| LocalError::compute_failed(&self.name, &error))
    }

    /// The condensed states of a picture, [1, queries, width].
    fn encode_picture(&self, picture: &Image) -> Result<Tensor, LocalError> {
        let pixels = self.processor.to_tensor(&[picture], &self.device)?;
        let condensed = self
            .vision
            .encode_pictures(&pixels)
            .and_then(|states| self.projection.apply_to(&self.queries.condense_states(&states)?));
        condensed.map_err(|error| LocalError::compute_failed(&self.name, &error))
    }
}

//! Turns sentences into vectors of length 1 that can be compared, as sentence-transformers does.

use super::{
    config::BertConfig,
    encoder::BertEncoder,
    modules::{SentenceModules, SentencePooling, unit_length},
};
use crate::{LocalError, ModelDevice, WeightPrecision, tokenizer::TextTokenizer, weights::CheckpointWeights};
use candle_core::{DType, Tensor};
use std::path::Path;
use wayword_core::{ModelError, TextEncoder};

/// The number of texts that are encoded together.
const TEXTS_PER_BATCH: usize = 32;

/// A sentence encoder: texts with a similar meaning get vectors with a large dot product.
pub struct SentenceEncoder {
    name: String,
    tokenizer: TextTokenizer,
    encoder: BertEncoder,
    modules: SentenceModules,
    /// The most tokens of a text. The rest is cut off.
    longest: usize,
    device: ModelDevice,
}

impl SentenceEncoder {
    /// Reads `config.json`, `tokenizer.json`, `model.safetensors` and, if they exist, the other files of
    /// [`crate::NeededFiles::for_sentence_encoder`] in a folder. `name` is the model's name: `hf/ORG/NAME`.
    ///
    /// # Errors
    /// When a file is missing or damaged, the checkpoint has another architecture, or the encoder does something to texts or
    /// vectors that is not done here.
    pub fn load(
        name: &str,
        folder: &Path,
        device: &ModelDevice,
        precision: WeightPrecision,
    ) -> Result<Self, LocalError> {
        let config = BertConfig::from_folder(folder)?;
        let weights = CheckpointWeights::open(folder, device, precision)?;
        // A checkpoint of a whole BERT model has the encoder under the name `bert`.
        let root = weights.scope_under("");
        let encoder =
            if root.has_tensor("embeddings.word_embeddings.weight") { root } else { weights.scope_under("bert") };
        Ok(Self {
            name: name.to_owned(),
            tokenizer: TextTokenizer::load(folder)?,
            encoder: BertEncoder::from_weights(&encoder, &config)?,
            modules: SentenceModules::from_folder(folder, config.hidden_size(), device, precision)?,
            longest: config.max_text_tokens(folder)?,
            device: device.clone(),
        })
    }

    /// Unit vectors of texts. Texts of similar length are encoded together, so that there is little padding.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn unit_vectors(&self, texts: &[&str]) -> Result<Vec<Vec<f32>>, LocalError> {
        let ids = texts.iter().map(|text| self.tokenizer.text_ids(&self.modules.prepare_text(text), self.longest));
        let ids: Vec<Vec<u32>> = ids.collect::<Result<_, _>>()?;
        let mut order: Vec<usize> = (0..texts.len()).collect();
        order.sort_by_key(|&at| ids[at].len());
        let mut vectors = vec![Vec::new(); texts.len()];
        for batch in order.chunks(TEXTS_PER_BATCH) {
            let batch_ids: Vec<&[u32]> = batch.iter().map(|&at| &ids[at][..]).collect();
            let batch_vectors = self.encode_batch(&batch_ids);
            let batch_vectors = batch_vectors
                .map_err(|error| LocalError::Compute { model: self.name.clone(), problem: error.to_string() })?;
            for (&at, vector) in batch.iter().zip(batch_vectors) {
                vectors[at] = vector;
            }
        }
        Ok(vectors)
    }

    /// Unit vectors of texts, given as ids. Shorter texts are padded to the longest, and the padding is hidden from the
    /// attention and from the mean.
    fn encode_batch(&self, texts: &[&[u32]]) -> candle_core::Result<Vec<Vec<f32>>> {
        let device = &self.device.0;
        let longest = texts.iter().map(|ids| ids.len()).max().unwrap_or(0).max(1);
        let padded = |ids: &&[u32]| ids.iter().copied().chain(std::iter::repeat(0)).take(longest).collect::<Vec<_>>();
        let ids = Tensor::from_vec(texts.iter().flat_map(padded).collect(), (texts.len(), longest), device)?;
        let is_token = |at: usize| at % longest < texts[at / longest].len();
        let per_token = |for_token: f32, for_padding: f32| {
            let numbers =
                (0..texts.len() * longest).map(|at| if is_token(at) { for_token } else { for_padding }).collect();
            Tensor::from_vec(numbers, (texts.len(), longest), device)
        };
        let is_even = texts.iter().all(|ids| ids.len() == longest);
        let padding_mask =
            if is_even { None } else { Some(per_token(0.0, f32::NEG_INFINITY)?.unsqueeze(1)?.unsqueeze(1)?) };
        let states = self.encoder.encode_tokens(&ids, padding_mask.as_ref())?.to_dtype(DType::F32)?;
        let pool = |pooling: &SentencePooling| match pooling {
            SentencePooling::First => states.narrow(1, 0, 1)?.squeeze(1),
            SentencePooling::Last => {
                let last = texts.iter().enumerate().map(|(at, ids)| (at * longest + ids.len().max(1) - 1) as u32);
                let last = Tensor::from_vec(last.collect(), texts.len(), device)?;
                states.flatten(0, 1)?.index_select(&last, 0)
            }
            SentencePooling::Mean if is_even => states.mean(1),
            SentencePooling::Mean => {
                let weights = per_token(1.0, 0.0)?.unsqueeze(2)?;
                states.broadcast_mul(&weights)?.sum(1)?.broadcast_div(&weights.sum(1)?)
            }
        };
        let pooled: Vec<Tensor> = self.modules.poolings.iter().map(pool).collect::<candle_core::Result<_>>()?;
        let vectors = self.modules.apply_layers(Tensor::cat(&pooled, 1)?)?;
        unit_length(&vectors)?.to_dtype(DType::F32)?.to_vec2()
    }
}

impl TextEncoder for SentenceEncoder {
    fn name(&self) -> &str {
        &self.name
    }

    fn encode_texts(&self, texts: &[&str]) -> Result<Vec<Vec<f32>>, ModelError> {
        self.unit_vectors(texts)
            .map_err(|error| ModelError::Failed { model: self.name.clone(), reason: error.to_string() })
    }
}

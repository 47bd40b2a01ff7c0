//! BLIP's text decoder. It writes an answer or a description token by token, and always takes the most likely token.

use super::{
    config::TextConfig,
    text::{BlipKeysValues, TextModel},
};
use crate::{
    LocalError,
    greedy::decode_greedily,
    ops::{Activation, LayerNorm, LinearLayer},
    weights::WeightScope,
};
use candle_core::{Device, Result, Tensor};

/// A text model with a head that predicts the next token.
pub(super) struct BlipDecoder {
    pub(super) text: TextModel,
    /// The head: a layer with an activation, a norm, and the layer that scores all words of the vocabulary.
    dense: LinearLayer,
    activation: Activation,
    norm: LayerNorm,
    words: LinearLayer,
    /// The ids of the tokens that begin and end every text.
    begin: u32,
    end: u32,
    /// The most tokens of a text.
    longest: usize,
}

impl BlipDecoder {
    pub(super) fn from_weights(
        weights: &WeightScope<'_>,
        config: &TextConfig,
    ) -> std::result::Result<Self, LocalError> {
        let (size, count) = (config.hidden_size, config.vocab_size);
        let head = weights.sub_scope("cls.predictions");
        // Checkpoints leave out tensors that are tied to another one.
        let table = if head.has_tensor("decoder.weight") {
            head.sub_scope("decoder")
        } else {
            weights.sub_scope("bert.embeddings.word_embeddings")
        };
        let bias = if head.has_tensor("bias") { head.clone() } else { head.sub_scope("decoder") };
        let words =
            LinearLayer::new(&table.read_tensor("weight", &[count, size])?, Some(bias.read_tensor("bias", &[count])?));
        Ok(Self {
            text: TextModel::from_weights(&weights.sub_scope("bert"), config)?,
            dense: head.read_linear("transform.dense", size, size)?,
            activation: config.hidden_act,
            norm: head.read_layer_norm("transform.LayerNorm", size, config.layer_norm_eps)?,
            words: words.map_err(|error| table.tensor_error("weight", &error))?,
            begin: config.bos_token_id,
            end: config.sep_token_id,
            longest: config.max_position_embeddings,
        })
    }

    /// Logits [1, length, words] from states [1, length, size].
    pub(super) fn token_logits(&self, states: &Tensor) -> Result<Tensor> {
        self.words.apply_to(&self.norm.apply_to(&self.dense.apply_and_activate(states, self.activation)?)?)
    }

    /// The tokens that continue a prompt: at most `max_tokens`, without the one that ends a text. `prompt` does not
    /// contain the token that begins every text. `attended` comes from the picture or the question.
    pub(super) fn generate_tokens(
        &self,
        prompt: &[u32],
        attended: &BlipKeysValues,
        max_tokens: usize,
        device: &Device,
    ) -> Result<Vec<u32>> {
        let first_tokens: Vec<u32> = std::iter::once(self.begin).chain(prompt.iter().copied()).collect();
        let mut past = self.text.empty_past();
        decode_greedily(max_tokens.min(self.longest.saturating_sub(first_tokens.len())), self.end, |token| {
            let next = token.map_or_else(|| first_tokens.clone(), |token| vec![token]);
            let states = self.text.continue_text(&Tensor::new(next, device)?.unsqueeze(0)?, attended, &mut past)?;
            self.token_logits(&states.narrow(1, states.dim(1)? - 1, 1)?)
        })
    }
}

//! BLIP's text decoder. It writes an answer or a description token by token, and always takes the most likely token.

use super::{
    config::TextConfig,
    text::{Attended, TextModel},
};
use crate::{
    LocalError,
    greedy::greedy,
    ops::{Activation, LayerNorm, Linear},
    weights::Scope,
};
use candle_core::{Device, Result, Tensor};

/// A text model with a head that predicts the next token.
pub(super) struct Decoder {
    pub(super) text: TextModel,
    dense: Linear,
    activation: Activation,
    norm: LayerNorm,
    words: Linear,
    begin: u32,
    end: u32,
    longest: usize,
}

impl Decoder {
    pub(super) fn load(weights: &Scope<'_>, config: &TextConfig) -> std::result::Result<Self, LocalError> {
        let (size, count) = (config.hidden_size, config.vocab_size);
        let head = weights.sub("cls.predictions");
        // Checkpoints leave out tensors that are tied to another one.
        let table = if head.has("decoder.weight") {
            head.sub("decoder")
        } else {
            weights.sub("bert.embeddings.word_embeddings")
        };
        let bias = if head.has("bias") { head.clone() } else { head.sub("decoder") };
        let words = Linear::new(&table.tensor("weight", &[count, size])?, Some(bias.tensor("bias", &[count])?));
        Ok(Self {
            text: TextModel::load(&weights.sub("bert"), config)?,
            dense: head.linear("transform.dense", size, size)?,
            activation: config.hidden_act,
            norm: head.layer_norm("transform.LayerNorm", size, config.layer_norm_eps)?,
            words: words.map_err(|error| table.wrong("weight", &error))?,
            begin: config.bos_token_id,
            end: config.sep_token_id,
            longest: config.max_position_embeddings,
        })
    }

    /// Logits [1, length, words] from states [1, length, size].
    pub(super) fn logits(&self, states: &Tensor) -> Result<Tensor> {
        self.words.of(&self.norm.of(&self.dense.of_then(states, self.activation)?)?)
    }

    /// The tokens that continue a prompt: at most `most`, without the one that ends a text. `prompt` does not contain
    /// the token that begins every text.
    pub(super) fn speak(&self, prompt: &[u32], attended: &Attended, most: usize, device: &Device) -> Result<Vec<u32>> {
        let begun: Vec<u32> = std::iter::once(self.begin).chain(prompt.iter().copied()).collect();
        let mut past = self.text.past();
        greedy(most.min(self.longest.saturating_sub(begun.len())), self.end, |token| {
            let next = token.map_or_else(|| begun.clone(), |token| vec![token]);
            let states = self.text.go_on(&Tensor::new(next, device)?.unsqueeze(0)?, attended, &mut past)?;
            self.logits(&states.narrow(1, states.dim(1)? - 1, 1)?)
        })
    }
}

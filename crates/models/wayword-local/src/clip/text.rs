//! CLIP's text tower (transformers' `CLIPTextModel`): one state for each text.

use super::{config::TextConfig, layers::ClipLayers};
use crate::{
    LocalError,
    ops::{EmbeddingTable, LayerNorm, causal_mask},
    weights::WeightScope,
};
use candle_core::{Result, Tensor};

/// The token that old configurations name as the end of a text. It is wrong, and is ignored.
const WRONG_END_TOKEN_ID: u32 = 2;

/// Computes one state for each text.
pub(crate) struct TextTower {
    words: EmbeddingTable,
    positions: EmbeddingTable,
    layers: ClipLayers,
    norm: LayerNorm,
    /// The token that ends a text. `None` for the one with the highest id.
    end: Option<u32>,
}

impl TextTower {
    pub(crate) fn from_weights(
        weights: &WeightScope<'_>,
        config: &TextConfig,
    ) -> std::result::Result<Self, LocalError> {
        let (size, epsilon) = (config.layers.hidden_size, config.layers.layer_norm_eps);
        let embeddings = weights.sub_scope("embeddings");
        Ok(Self {
            words: embeddings.read_embedding("token_embedding", config.vocab_size, size)?,
            positions: embeddings.read_embedding("position_embedding", config.max_position_embeddings, size)?,
            layers: ClipLayers::from_weights(&weights.sub_scope("encoder.layers"), &config.layers)?,
            norm: weights.read_layer_norm("final_layer_norm", size, epsilon)?,
            end: config.eos_token_id.filter(|&end| end != WRONG_END_TOKEN_ID),
        })
    }

    /// The states [batch, 1, size] of the tokens that end the texts. Padding comes after the end of a text, so the mask
    /// hides it.
    pub(crate) fn encode_texts(&self, texts: &[&[u32]], device: &candle_core::Device) -> Result<Tensor> {
        let length = texts.iter().map(|ids| ids.len()).max().unwrap_or(0).max(1);
        let padded = |ids: &&[u32]| ids.iter().copied().chain(std::iter::repeat(0)).take(length).collect::<Vec<_>>();
        let ids = Tensor::from_vec(texts.iter().flat_map(padded).collect(), (texts.len(), length), device)?;
        let positions = self.positions.look_up(&Tensor::arange(0, length as u32, device)?)?;
        let x = self.words.look_up(&ids)?.broadcast_add(&positions)?;
        let ends: Vec<u32> = texts.iter().map(|ids| self.end_position(ids)).collect();
        let x = self.layers.states_at(x, Some(&causal_mask(length, length, device)?), &ends)?;
        self.norm.apply_to(&x)
    }

    /// The position at which a text ends: the first end token or, if the configuration names none or the wrong one, the
    /// first token with the highest id. 0 if there is none.
    fn end_position(&self, ids: &[u32]) -> u32 {
        let end = self.end.or_else(|| ids.iter().max().copied());
        ids.iter().position(|&id| Some(id) == end).unwrap_or(0) as u32
    }
}

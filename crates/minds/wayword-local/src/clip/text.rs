//! The tower that reads (transformers `CLIPTextModel`).

use super::{config::TextConfig, layers::Layers};
use crate::{
    LocalError,
    ops::{Embedding, LayerNorm, causal},
    weights::Scope,
};
use candle_core::{Result, Tensor};

/// Before this was mended, configurations named another token as the end.
const WRONG_END: u32 = 2;

/// Texts to one state each.
pub(super) struct TextTower {
    words: Embedding,
    positions: Embedding,
    layers: Layers,
    norm: LayerNorm,
    end: u32,
}

impl TextTower {
    pub(super) fn load(weights: &Scope<'_>, config: &TextConfig) -> std::result::Result<Self, LocalError> {
        let (size, epsilon) = (config.layers.hidden_size, config.layers.layer_norm_eps);
        let embeddings = weights.sub("embeddings");
        Ok(Self {
            words: embeddings.embedding("token_embedding", config.vocab_size, size)?,
            positions: embeddings.embedding("position_embedding", config.max_position_embeddings, size)?,
            layers: Layers::load(&weights.sub("encoder.layers"), &config.layers)?,
            norm: weights.layer_norm("final_layer_norm", size, epsilon)?,
            end: config.eos_token_id,
        })
    }

    /// Of texts' ids: the state of the token that ends each, [batch, 1, size]. What pads a shorter text comes after it, where
    /// nothing that came before looks.
    pub(super) fn of(&self, texts: &[&[u32]], device: &candle_core::Device) -> Result<Tensor> {
        let length = texts.iter().map(|ids| ids.len()).max().unwrap_or(0).max(1);
        let padded = |ids: &&[u32]| ids.iter().copied().chain(std::iter::repeat(0)).take(length).collect::<Vec<_>>();
        let ids = Tensor::from_vec(texts.iter().flat_map(padded).collect(), (texts.len(), length), device)?;
        let positions = self.positions.of(&Tensor::arange(0, length as u32, device)?)?;
        let x = self.words.of(&ids)?.broadcast_add(&positions)?;
        let ends: Vec<u32> = texts.iter().map(|ids| self.end_of(ids)).collect();
        let x = self.layers.of(x, Some(&causal(length, length, device)?), &ends)?;
        self.norm.of(&x)
    }

    /// Where a text ends: at the first token that is the end, or, where the configuration names the wrong one, at the first of
    /// the highest id; the first where there is none.
    fn end_of(&self, ids: &[u32]) -> u32 {
        let end = if self.end == WRONG_END { ids.iter().max().copied() } else { Some(self.end) };
        ids.iter().position(|&id| Some(id) == end).unwrap_or(0) as u32
    }
}

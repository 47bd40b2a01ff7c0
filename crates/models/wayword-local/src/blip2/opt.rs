//! The language model OPT (arXiv 2205.01068): a decoder that continues a text.

use super::config::OptConfig;
use crate::{
    LocalError,
    greedy::decode_greedily,
    ops::{Activation, EmbeddingTable, KeyValueCache, LayerNorm, LinearLayer, MultiHeadAttention, causal_mask},
    weights::WeightScope,
};
use candle_core::{Result, Tensor};

/// The number of the first position. OPT does not count from 0.
const FIRST_POSITION: usize = 2;

/// The epsilon of OPT's norms, which is added to variances so that no division is by 0.
const NORM_EPSILON: f64 = 1e-5;

/// An OPT that has its norms before each layer, as all but the 350m model have.
pub(super) struct OptModel {
    words: EmbeddingTable,
    positions: EmbeddingTable,
    layers: Vec<OptLayer>,
    norm: LayerNorm,
    /// Scores all words of the vocabulary as the next token.
    head: LinearLayer,
    /// The most tokens of a text, with those of the picture.
    longest: usize,
    /// The id of the token that ends a text.
    end: u32,
}

/// One layer: attention among the tokens, then a feed-forward network, each with a norm before it.
struct OptLayer {
    own_norm: LayerNorm,
    /// The layer for queries, keys and values, side by side.
    qkv: LinearLayer,
    /// The layer behind the attention.
    mixed: LinearLayer,
    norm: LayerNorm,
    /// The feed-forward network: from the width of a state to the inner width, and back.
    wide: LinearLayer,
    narrow: LinearLayer,
    heads: usize,
    activation: Activation,
}

impl OptModel {
    pub(super) fn from_weights(weights: &WeightScope<'_>, config: &OptConfig) -> std::result::Result<Self, LocalError> {
        let (size, count) = (config.hidden_size, config.vocab_size);
        let decoder = weights.sub_scope("model.decoder");
        // Checkpoints leave out tensors that are tied to another one.
        let head = if weights.has_tensor("lm_head.weight") {
            weights.sub_scope("lm_head")
        } else {
            decoder.sub_scope("embed_tokens")
        };
        let positions = config.max_position_embeddings + FIRST_POSITION;
        let layer = |at: usize| OptLayer::from_weights(&decoder.sub_scope("layers").sub_scope(at), config);
        Ok(Self {
            words: decoder.read_embedding("embed_tokens", count, size)?,
            positions: decoder.read_embedding("embed_positions", positions, size)?,
            layers: (0..config.num_hidden_layers).map(layer).collect::<std::result::Result<_, _>>()?,
            norm: decoder.read_layer_norm("final_layer_norm", size, NORM_EPSILON)?,
            head: LinearLayer::new(&head.read_tensor("weight", &[count, size])?, None)
                .map_err(|error| head.tensor_error("weight", &error))?,
            longest: config.max_position_embeddings,
            end: config.eos_token_id,
        })
    }

    /// The tokens that follow a picture's tokens [1, count, size] and a prompt's ids [1, length]: at most `max_tokens`.
    pub(super) fn generate_tokens(&self, picture: &Tensor, ids: &Tensor, max_tokens: usize) -> Result<Vec<u32>> {
        let mut past = vec![KeyValueCache::default(); self.layers.len()];
        let max_tokens = max_tokens.min(self.longest.saturating_sub(picture.dim(1)? + ids.dim(1)?));
        decode_greedily(max_tokens, self.end, |token| {
            let x = match token {
                None => Tensor::cat(&[picture, &self.words.look_up(ids)?], 1)?,
                Some(token) => self.words.look_up(&Tensor::new(&[[token]], picture.device())?)?,
            };
            self.continue_text(&x, &mut past)
        })
    }

    /// Reads the next tokens [1, length, size], and returns the logits of the token after them.
    fn continue_text(&self, x: &Tensor, past: &mut [KeyValueCache]) -> Result<Tensor> {
        let past_length = past.first().map_or(Ok(0), KeyValueCache::len)?;
        let length = x.dim(1)?;
        let from = (past_length + FIRST_POSITION) as u32;
        let positions = Tensor::arange(from, from + length as u32, x.device())?;
        let mask = if length > 1 { Some(causal_mask(length, past_length + length, x.device())?) } else { None };
        let mut x = x.broadcast_add(&self.positions.look_up(&positions)?)?;
        for (layer, past) in self.layers.iter().zip(past) {
            x = layer.apply_to(&x, mask.as_ref(), past)?;
        }
        self.head.apply_to(&self.norm.apply_to(&x.narrow(1, length - 1, 1)?)?)
    }
}

impl OptLayer {
    fn from_weights(weights: &WeightScope<'_>, config: &OptConfig) -> std::result::Result<Self, LocalError> {
        let size = config.hidden_size;
        Ok(Self {
            own_norm: weights.read_layer_norm("self_attn_layer_norm", size, NORM_EPSILON)?,
            qkv: weights.sub_scope("self_attn").read_joined_linears(&["q_proj", "k_proj", "v_proj"], size, size)?,
            mixed: weights.read_linear("self_attn.out_proj", size, size)?,
            norm: weights.read_layer_norm("final_layer_norm", size, NORM_EPSILON)?,
            wide: weights.read_linear("fc1", size, config.ffn_dim)?,
            narrow: weights.read_linear("fc2", config.ffn_dim, size)?,
            heads: config.num_attention_heads,
            activation: config.activation_function,
        })
    }

    fn apply_to(&self, x: &Tensor, mask: Option<&Tensor>, past: &mut KeyValueCache) -> Result<Tensor> {
        let size = x.dim(2)?;
        let qkv = self.qkv.apply_to(&self.own_norm.apply_to(x)?)?;
        let part = |at: usize| qkv.narrow(2, at * size, size);
        let (keys, values) = past.append_tokens(part(1)?, part(2)?)?;
        let scale = 1.0 / ((size / self.heads) as f32).sqrt();
        let mixed = MultiHeadAttention { heads: self.heads, scale, bias: mask }.attend_to(&part(0)?, &keys, &values)?;
        let x = (self.mixed.apply_to(&mixed)? + x)?;
        self.narrow.apply_to(&self.wide.apply_and_activate(&self.norm.apply_to(&x)?, self.activation)?)? + x
    }
}

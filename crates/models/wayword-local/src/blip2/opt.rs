//! The language model OPT (arXiv 2205.01068): a decoder that continues a text.

use super::config::OptConfig;
use crate::{
    LocalError,
    greedy::greedy,
    ops::{Activation, Attention, Embedding, LayerNorm, Linear, Past, causal},
    weights::Scope,
};
use candle_core::{Result, Tensor};

/// The number of the first position. OPT does not count from 0.
const FIRST_POSITION: usize = 2;

/// The epsilon of OPT's norms.
const EPSILON: f64 = 1e-5;

/// An OPT that has its norms before each layer, as all but the 350m model have.
pub(super) struct Opt {
    words: Embedding,
    positions: Embedding,
    layers: Vec<Layer>,
    norm: LayerNorm,
    head: Linear,
    longest: usize,
    end: u32,
}

struct Layer {
    own_norm: LayerNorm,
    qkv: Linear,
    mixed: Linear,
    norm: LayerNorm,
    wide: Linear,
    narrow: Linear,
    heads: usize,
    activation: Activation,
}

impl Opt {
    pub(super) fn load(weights: &Scope<'_>, config: &OptConfig) -> std::result::Result<Self, LocalError> {
        let (size, count) = (config.hidden_size, config.vocab_size);
        let decoder = weights.sub("model.decoder");
        // Checkpoints leave out tensors that are tied to another one.
        let head = if weights.has("lm_head.weight") { weights.sub("lm_head") } else { decoder.sub("embed_tokens") };
        let positions = config.max_position_embeddings + FIRST_POSITION;
        let layer = |at: usize| Layer::load(&decoder.sub("layers").sub(at), config);
        Ok(Self {
            words: decoder.embedding("embed_tokens", count, size)?,
            positions: decoder.embedding("embed_positions", positions, size)?,
            layers: (0..config.num_hidden_layers).map(layer).collect::<std::result::Result<_, _>>()?,
            norm: decoder.layer_norm("final_layer_norm", size, EPSILON)?,
            head: Linear::new(&head.tensor("weight", &[count, size])?, None)
                .map_err(|error| head.wrong("weight", &error))?,
            longest: config.max_position_embeddings,
            end: config.eos_token_id,
        })
    }

    /// The tokens that follow a picture's tokens [1, count, size] and a prompt's ids [1, length].
    pub(super) fn speak(&self, seen: &Tensor, ids: &Tensor, most: usize) -> Result<Vec<u32>> {
        let mut past = vec![Past::default(); self.layers.len()];
        let most = most.min(self.longest.saturating_sub(seen.dim(1)? + ids.dim(1)?));
        greedy(most, self.end, |token| {
            let x = match token {
                None => Tensor::cat(&[seen, &self.words.of(ids)?], 1)?,
                Some(token) => self.words.of(&Tensor::new(&[[token]], seen.device())?)?,
            };
            self.go_on(&x, &mut past)
        })
    }

    /// Reads the next tokens [1, length, size], and returns the logits of the token after them.
    fn go_on(&self, x: &Tensor, past: &mut [Past]) -> Result<Tensor> {
        let before = past.first().map_or(Ok(0), Past::len)?;
        let length = x.dim(1)?;
        let from = (before + FIRST_POSITION) as u32;
        let positions = Tensor::arange(from, from + length as u32, x.device())?;
        let mask = if length > 1 { Some(causal(length, before + length, x.device())?) } else { None };
        let mut x = x.broadcast_add(&self.positions.of(&positions)?)?;
        for (layer, past) in self.layers.iter().zip(past) {
            x = layer.of(&x, mask.as_ref(), past)?;
        }
        self.head.of(&self.norm.of(&x.narrow(1, length - 1, 1)?)?)
    }
}

impl Layer {
    fn load(weights: &Scope<'_>, config: &OptConfig) -> std::result::Result<Self, LocalError> {
        let size = config.hidden_size;
        Ok(Self {
            own_norm: weights.layer_norm("self_attn_layer_norm", size, EPSILON)?,
            qkv: weights.sub("self_attn").linears(&["q_proj", "k_proj", "v_proj"], size, size)?,
            mixed: weights.linear("self_attn.out_proj", size, size)?,
            norm: weights.layer_norm("final_layer_norm", size, EPSILON)?,
            wide: weights.linear("fc1", size, config.ffn_dim)?,
            narrow: weights.linear("fc2", config.ffn_dim, size)?,
            heads: config.num_attention_heads,
            activation: config.activation_function,
        })
    }

    fn of(&self, x: &Tensor, mask: Option<&Tensor>, past: &mut Past) -> Result<Tensor> {
        let size = x.dim(2)?;
        let qkv = self.qkv.of(&self.own_norm.of(x)?)?;
        let part = |at: usize| qkv.narrow(2, at * size, size);
        let (keys, values) = past.grow(part(1)?, part(2)?)?;
        let scale = 1.0 / ((size / self.heads) as f32).sqrt();
        let mixed = Attention { heads: self.heads, scale, bias: mask }.of(&part(0)?, &keys, &values)?;
        let x = (self.mixed.of(&mixed)? + x)?;
        self.narrow.of(&self.wide.of_then(&self.norm.of(&x)?, self.activation)?)? + x
    }
}

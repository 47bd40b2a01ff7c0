//! BLIP's text model: a BERT with a second attention in each layer. In the encoder and in the describing decoder it
//! looks at the picture, in the answering decoder at the encoder's states of the question.

use super::config::TextConfig;
use crate::{
    LocalError,
    ops::{Activation, EmbeddingTable, KeyValueCache, LayerNorm, LinearLayer, MultiHeadAttention, causal_mask},
    weights::WeightScope,
};
use candle_core::{Result, Tensor};

/// Computes a state for each token of a text.
pub(super) struct TextModel {
    words: EmbeddingTable,
    positions: EmbeddingTable,
    norm: LayerNorm,
    layers: Vec<BlipTextLayer>,
}

/// The keys and values, layer by layer, of the states that tokens attend to. They are computed once.
pub(super) type BlipKeysValues = Vec<(Tensor, Tensor)>;

/// One layer: attention among the tokens, attention to the picture or the question, then a feed-forward network.
struct BlipTextLayer {
    own: BlipSelfAttention,
    /// The attention to the picture or the question: queries of the tokens, and keys and values of what they look at.
    cross_query: LinearLayer,
    cross_keys_values: LinearLayer,
    cross: BlipTextOutput,
    /// The feed-forward network: from the width of a state to the inner width, and back.
    wide: LinearLayer,
    narrow: BlipTextOutput,
    heads: usize,
    activation: Activation,
}

/// Attention among the tokens themselves.
struct BlipSelfAttention {
    /// The layer for queries, keys and values, side by side.
    qkv: LinearLayer,
    output: BlipTextOutput,
}

/// A linear layer with a residual: its output is added to an earlier state, and a norm follows.
struct BlipTextOutput {
    dense: LinearLayer,
    norm: LayerNorm,
}

impl TextModel {
    pub(super) fn from_weights(
        weights: &WeightScope<'_>,
        config: &TextConfig,
    ) -> std::result::Result<Self, LocalError> {
        let size = config.hidden_size;
        let embeddings = weights.sub_scope("embeddings");
        let layers = (0..config.num_hidden_layers)
            .map(|layer| BlipTextLayer::from_weights(&weights.sub_scope("encoder.layer").sub_scope(layer), config));
        Ok(Self {
            words: embeddings.read_embedding("word_embeddings", config.vocab_size, size)?,
            positions: embeddings.read_embedding("position_embeddings", config.max_position_embeddings, size)?,
            norm: embeddings.read_layer_norm("LayerNorm", size, config.layer_norm_eps)?,
            layers: layers.collect::<std::result::Result<_, _>>()?,
        })
    }

    /// The keys and values of states [1, count, size] that tokens will attend to.
    pub(super) fn cross_keys_values(&self, states: &Tensor) -> Result<BlipKeysValues> {
        let keys_values = |layer: &BlipTextLayer| {
            let both = layer.cross_keys_values.apply_to(states)?;
            let size = both.dim(2)? / 2;
            Ok((both.narrow(2, 0, size)?, both.narrow(2, size, size)?))
        };
        self.layers.iter().map(keys_values).collect()
    }

    /// The states [1, length, size] of a whole text [1, length]. Each token sees all others.
    pub(super) fn encode_text(&self, ids: &Tensor, attended: &BlipKeysValues) -> Result<Tensor> {
        let x = self.embed_tokens(ids, 0)?;
        self.layers
            .iter()
            .zip(attended)
            .try_fold(x, |x, (layer, attended)| layer.apply_to(&x, attended, None, &mut KeyValueCache::default()))
    }

    /// The empty cache before the first token, layer by layer.
    pub(super) fn empty_past(&self) -> Vec<KeyValueCache> {
        vec![KeyValueCache::default(); self.layers.len()]
    }

    /// The states [1, length, size] of the next tokens [1, length] after those of `past`. Each sees the tokens before
    /// it.
    pub(super) fn continue_text(
        &self,
        ids: &Tensor,
        attended: &BlipKeysValues,
        past: &mut [KeyValueCache],
    ) -> Result<Tensor> {
        let past_length = past.first().map_or(Ok(0), KeyValueCache::len)?;
        let length = ids.dim(1)?;
        let mask = if length > 1 { Some(causal_mask(length, past_length + length, ids.device())?) } else { None };
        let mut x = self.embed_tokens(ids, past_length)?;
        for ((layer, attended), past) in self.layers.iter().zip(attended).zip(past) {
            x = layer.apply_to(&x, attended, mask.as_ref(), past)?;
        }
        Ok(x)
    }

    /// The states of tokens before the first layer. The first of them has the position `past_length`.
    fn embed_tokens(&self, ids: &Tensor, past_length: usize) -> Result<Tensor> {
        let (from, to) = (past_length as u32, (past_length + ids.dim(1)?) as u32);
        let positions = self.positions.look_up(&Tensor::arange(from, to, ids.device())?)?;
        self.norm.apply_to(&self.words.look_up(ids)?.broadcast_add(&positions)?)
    }
}

impl BlipTextLayer {
    fn from_weights(weights: &WeightScope<'_>, config: &TextConfig) -> std::result::Result<Self, LocalError> {
        let (size, inner, epsilon) = (config.hidden_size, config.intermediate_size, config.layer_norm_eps);
        let output = |name: &str, inputs: usize| -> std::result::Result<BlipTextOutput, LocalError> {
            let layer = weights.sub_scope(name);
            Ok(BlipTextOutput {
                dense: layer.read_linear("dense", inputs, size)?,
                norm: layer.read_layer_norm("LayerNorm", size, epsilon)?,
            })
        };
        let cross = weights.sub_scope("crossattention.self");
        Ok(Self {
            own: BlipSelfAttention {
                qkv: weights.sub_scope("attention.self").read_joined_linears(&["query", "key", "value"], size, size)?,
                output: output("attention.output", size)?,
            },
            cross_query: cross.read_linear("query", size, size)?,
            cross_keys_values: cross.read_joined_linears(&["key", "value"], config.encoder_hidden_size, size)?,
            cross: output("crossattention.output", size)?,
            wide: weights.read_linear("intermediate.dense", size, inner)?,
            narrow: output("output", inner)?,
            heads: config.num_attention_heads,
            activation: config.hidden_act,
        })
    }

    fn apply_to(
        &self,
        x: &Tensor,
        attended: &(Tensor, Tensor),
        mask: Option<&Tensor>,
        past: &mut KeyValueCache,
    ) -> Result<Tensor> {
        let size = x.dim(2)?;
        let scale = 1.0 / ((size / self.heads) as f32).sqrt();
        let qkv = self.own.qkv.apply_to(x)?;
        let part = |at: usize| qkv.narrow(2, at * size, size);
        let (keys, values) = past.append_tokens(part(1)?, part(2)?)?;
        let mixed = MultiHeadAttention { heads: self.heads, scale, bias: mask }.attend_to(&part(0)?, &keys, &values)?;
        let x = self.own.output.add_and_norm(&mixed, x)?;
        let cross_attention = MultiHeadAttention { heads: self.heads, scale, bias: None };
        let x = self
            .cross
            .add_and_norm(&cross_attention.attend_to(&self.cross_query.apply_to(&x)?, &attended.0, &attended.1)?, &x)?;
        self.narrow.add_and_norm(&self.wide.apply_and_activate(&x, self.activation)?, &x)
    }
}

impl BlipTextOutput {
    /// The norm of the layer's output for x, plus the earlier state `before`.
    fn add_and_norm(&self, x: &Tensor, before: &Tensor) -> Result<Tensor> {
        self.norm.apply_to(&(self.dense.apply_to(x)? + before)?)
    }
}

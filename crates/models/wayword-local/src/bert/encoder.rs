//! BERT's encoder (transformers `BertModel` without its pooler).

use super::config::BertConfig;
use crate::{
    LocalError,
    ops::{Activation, EmbeddingTable, FeedForward, LayerNorm, LinearLayer, MultiHeadAttention},
    weights::WeightScope,
};
use candle_core::{Result, Tensor};

/// Computes a state for each token of a text: a vector that depends on the token and on the tokens around it.
pub(crate) struct BertEncoder {
    words: EmbeddingTable,
    positions: EmbeddingTable,
    /// The vector of the first token type, which is added to every token. The second type is for pairs of texts.
    kind: Tensor,
    norm: LayerNorm,
    layers: Vec<BertLayer>,
}

/// One layer of an encoder: attention, then two linear layers, each with a residual and a norm. GLIP also uses single
/// layers.
pub(crate) struct BertLayer {
    /// The layer for queries, keys and values, side by side.
    qkv: LinearLayer,
    /// The layer behind the attention, and the norm behind its residual.
    mixed: LinearLayer,
    mixed_norm: LayerNorm,
    /// The feed-forward network: from the width of a state to the inner width, and back.
    wide: LinearLayer,
    narrow: LinearLayer,
    norm: LayerNorm,
    heads: usize,
    activation: Activation,
}

impl BertEncoder {
    pub(crate) fn from_weights(
        weights: &WeightScope<'_>,
        config: &BertConfig,
    ) -> std::result::Result<Self, LocalError> {
        let (size, epsilon) = (config.hidden_size, config.layer_norm_eps);
        let embeddings = weights.sub_scope("embeddings");
        let kinds = embeddings.read_embedding("token_type_embeddings", config.type_vocab_size, size)?;
        let layers = (0..config.num_hidden_layers)
            .map(|layer| BertLayer::from_weights(&weights.sub_scope("encoder.layer").sub_scope(layer), config));
        let kind = kinds.whole_table().get(0).and_then(|kind| kind.to_dtype(candle_core::DType::F32));
        Ok(Self {
            words: embeddings.read_embedding("word_embeddings", config.vocab_size, size)?,
            positions: embeddings.read_embedding("position_embeddings", config.max_position_embeddings, size)?,
            kind: kind.map_err(|error| embeddings.tensor_error("token_type_embeddings.weight", &error))?,
            norm: embeddings.read_layer_norm("LayerNorm", size, epsilon)?,
            layers: layers.collect::<std::result::Result<_, _>>()?,
        })
    }

    /// The states [batch, length, size] of ids [batch, length]. `mask` [batch, 1, 1, length] hides padding.
    pub(crate) fn encode_tokens(&self, ids: &Tensor, mask: Option<&Tensor>) -> Result<Tensor> {
        self.encode_tokens_at(ids, &Tensor::arange(0, ids.dim(1)? as u32, ids.device())?, mask)
    }

    /// Like [`BertEncoder::encode_tokens`], for tokens with other positions [length] than 0, 1, 2 .., and a mask that
    /// can be broadcast to [batch, heads, length, length].
    pub(crate) fn encode_tokens_at(&self, ids: &Tensor, positions: &Tensor, mask: Option<&Tensor>) -> Result<Tensor> {
        let positions = self.positions.look_up(positions)?;
        let x = self
            .words
            .look_up(ids)?
            .broadcast_add(&positions.broadcast_add(&self.kind.to_dtype(positions.dtype())?)?)?;
        self.layers.iter().try_fold(self.norm.apply_to(&x)?, |x, layer| layer.apply_to(&x, mask))
    }
}

impl BertLayer {
    pub(crate) fn from_weights(
        weights: &WeightScope<'_>,
        config: &BertConfig,
    ) -> std::result::Result<Self, LocalError> {
        let (size, inner, epsilon) = (config.hidden_size, config.intermediate_size, config.layer_norm_eps);
        Ok(Self {
            qkv: weights.sub_scope("attention.self").read_joined_linears(&["query", "key", "value"], size, size)?,
            mixed: weights.read_linear("attention.output.dense", size, size)?,
            mixed_norm: weights.read_layer_norm("attention.output.LayerNorm", size, epsilon)?,
            wide: weights.read_linear("intermediate.dense", size, inner)?,
            narrow: weights.read_linear("output.dense", inner, size)?,
            norm: weights.read_layer_norm("output.LayerNorm", size, epsilon)?,
            heads: config.num_attention_heads,
            activation: config.hidden_act,
        })
    }

    /// Computes the next states from states [batch, length, size]. The shape stays the same.
    pub(crate) fn apply_to(&self, x: &Tensor, mask: Option<&Tensor>) -> Result<Tensor> {
        let size = x.dim(2)?;
        let qkv = self.qkv.apply_to(x)?;
        let part = |at: usize| qkv.narrow(2, at * size, size);
        let scale = 1.0 / ((size / self.heads) as f32).sqrt();
        let mixed =
            MultiHeadAttention { heads: self.heads, scale, bias: mask }.attend_to(&part(0)?, &part(1)?, &part(2)?)?;
        let feed_forward = FeedForward {
            before: None,
            wide: &self.wide,
            activation: self.activation,
            narrow: &self.narrow,
            after: Some(&self.norm),
        };
        feed_forward.apply_to(&self.mixed.apply_add_and_norm(&mixed, x, &self.mixed_norm)?)
    }
}

//! The Q-Former: a few learned queries look at the hundreds of states of a picture, and take from them what the
//! language model needs.

use super::config::QFormerConfig;
use crate::{
    LocalError,
    ops::{Activation, LayerNorm, LinearLayer, MultiHeadAttention},
    weights::WeightScope,
};
use candle_core::{Result, Tensor};

/// Condenses the states of a picture to a few states.
pub(super) struct QFormer {
    /// The learned queries before the first layer, [1, queries, size].
    tokens: Tensor,
    norm: LayerNorm,
    layers: Vec<QFormerLayer>,
}

/// One layer: attention among the queries, in some layers attention to the picture, then a feed-forward network.
struct QFormerLayer {
    /// The layer for queries, keys and values, side by side.
    qkv: LinearLayer,
    /// The layer behind the attention among the queries.
    own: QFormerOutput,
    cross: Option<QFormerCrossAttention>,
    /// The feed-forward network: from the width of a state to the inner width, and back.
    wide: LinearLayer,
    narrow: QFormerOutput,
    heads: usize,
    activation: Activation,
}

/// Attention to the picture, which only some layers have (`cross_attention_frequency`).
struct QFormerCrossAttention {
    query: LinearLayer,
    keys_values: LinearLayer,
    output: QFormerOutput,
}

/// A linear layer with a residual: its output is added to an earlier state, and a norm follows.
struct QFormerOutput {
    dense: LinearLayer,
    norm: LayerNorm,
}

impl QFormer {
    pub(super) fn from_weights(
        weights: &WeightScope<'_>,
        config: &QFormerConfig,
        count: usize,
    ) -> std::result::Result<Self, LocalError> {
        let (size, all) = (config.hidden_size, weights.sub_scope("qformer"));
        let layer = |at: usize| {
            let has_cross = at.is_multiple_of(config.cross_attention_frequency);
            QFormerLayer::from_weights(&all.sub_scope("encoder.layer").sub_scope(at), config, has_cross)
        };
        Ok(Self {
            tokens: weights.read_state("query_tokens", &[1, count, size])?,
            norm: all.read_layer_norm("layernorm", size, config.layer_norm_eps)?,
            layers: (0..config.num_hidden_layers).map(layer).collect::<std::result::Result<_, _>>()?,
        })
    }

    /// Condenses the states [1, count, size] of a picture to [1, queries, size].
    pub(super) fn condense_states(&self, states: &Tensor) -> Result<Tensor> {
        self.layers.iter().try_fold(self.norm.apply_to(&self.tokens)?, |x, layer| layer.apply_to(&x, states))
    }
}

impl QFormerLayer {
    fn from_weights(
        weights: &WeightScope<'_>,
        config: &QFormerConfig,
        has_cross: bool,
    ) -> std::result::Result<Self, LocalError> {
        let (size, inner) = (config.hidden_size, config.intermediate_size);
        let output = |name: &str, inputs: usize| -> std::result::Result<QFormerOutput, LocalError> {
            let layer = weights.sub_scope(name);
            let norm = layer.read_layer_norm("LayerNorm", size, config.layer_norm_eps)?;
            Ok(QFormerOutput { dense: layer.read_linear("dense", inputs, size)?, norm })
        };
        let cross = || -> std::result::Result<QFormerCrossAttention, LocalError> {
            let attention = weights.sub_scope("crossattention.attention");
            Ok(QFormerCrossAttention {
                query: attention.read_linear("query", size, size)?,
                keys_values: attention.read_joined_linears(&["key", "value"], config.encoder_hidden_size, size)?,
                output: output("crossattention.output", size)?,
            })
        };
        Ok(Self {
            qkv: weights.sub_scope("attention.attention").read_joined_linears(
                &["query", "key", "value"],
                size,
                size,
            )?,
            own: output("attention.output", size)?,
            cross: if has_cross { Some(cross()?) } else { None },
            wide: weights.read_linear("intermediate_query.dense", size, inner)?,
            narrow: output("output_query", inner)?,
            heads: config.num_attention_heads,
            activation: config.hidden_act,
        })
    }

    fn apply_to(&self, x: &Tensor, states: &Tensor) -> Result<Tensor> {
        let size = x.dim(2)?;
        let scale = 1.0 / ((size / self.heads) as f32).sqrt();
        let attention = MultiHeadAttention { heads: self.heads, scale, bias: None };
        let qkv = self.qkv.apply_to(x)?;
        let part = |at: usize| qkv.narrow(2, at * size, size);
        let mut x = self.own.add_and_norm(&attention.attend_to(&part(0)?, &part(1)?, &part(2)?)?, x)?;
        if let Some(cross) = &self.cross {
            let keys_values = cross.keys_values.apply_to(states)?;
            let (keys, values) = (keys_values.narrow(2, 0, size)?, keys_values.narrow(2, size, size)?);
            x = cross.output.add_and_norm(&attention.attend_to(&cross.query.apply_to(&x)?, &keys, &values)?, &x)?;
        }
        self.narrow.add_and_norm(&self.wide.apply_and_activate(&x, self.activation)?, &x)
    }
}

impl QFormerOutput {
    /// The norm of the layer's output for x, plus the earlier state `before`.
    fn add_and_norm(&self, x: &Tensor, before: &Tensor) -> Result<Tensor> {
        self.norm.apply_to(&(self.dense.apply_to(x)? + before)?)
    }
}

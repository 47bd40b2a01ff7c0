//! The Q-Former: a few learned queries look at the hundreds of states of a picture, and take from them what the
//! language model needs.

use super::config::QFormerConfig;
use crate::{
    LocalError,
    ops::{Activation, Attention, LayerNorm, Linear},
    weights::Scope,
};
use candle_core::{Result, Tensor};

/// Condenses the states of a picture to a few states.
pub(super) struct QFormer {
    tokens: Tensor,
    norm: LayerNorm,
    layers: Vec<Layer>,
}

struct Layer {
    qkv: Linear,
    own: Output,
    cross: Option<Cross>,
    wide: Linear,
    narrow: Output,
    heads: usize,
    activation: Activation,
}

/// Attention to the picture, which only some layers have (`cross_attention_frequency`).
struct Cross {
    query: Linear,
    keys_values: Linear,
    output: Output,
}

/// A linear layer with a residual: its output is added to an earlier state, and a norm follows.
struct Output {
    dense: Linear,
    norm: LayerNorm,
}

impl QFormer {
    pub(super) fn load(
        weights: &Scope<'_>,
        config: &QFormerConfig,
        count: usize,
    ) -> std::result::Result<Self, LocalError> {
        let (size, all) = (config.hidden_size, weights.sub("qformer"));
        let layer = |at: usize| {
            let has_cross = at.is_multiple_of(config.cross_attention_frequency);
            Layer::load(&all.sub("encoder.layer").sub(at), config, has_cross)
        };
        Ok(Self {
            tokens: weights.state("query_tokens", &[1, count, size])?,
            norm: all.layer_norm("layernorm", size, config.layer_norm_eps)?,
            layers: (0..config.num_hidden_layers).map(layer).collect::<std::result::Result<_, _>>()?,
        })
    }

    /// Condenses the states [1, count, size] of a picture to [1, queries, size].
    pub(super) fn of(&self, states: &Tensor) -> Result<Tensor> {
        self.layers.iter().try_fold(self.norm.of(&self.tokens)?, |x, layer| layer.of(&x, states))
    }
}

impl Layer {
    fn load(weights: &Scope<'_>, config: &QFormerConfig, has_cross: bool) -> std::result::Result<Self, LocalError> {
        let (size, inner) = (config.hidden_size, config.intermediate_size);
        let output = |name: &str, inputs: usize| -> std::result::Result<Output, LocalError> {
            let layer = weights.sub(name);
            let norm = layer.layer_norm("LayerNorm", size, config.layer_norm_eps)?;
            Ok(Output { dense: layer.linear("dense", inputs, size)?, norm })
        };
        let cross = || -> std::result::Result<Cross, LocalError> {
            let attention = weights.sub("crossattention.attention");
            Ok(Cross {
                query: attention.linear("query", size, size)?,
                keys_values: attention.linears(&["key", "value"], config.encoder_hidden_size, size)?,
                output: output("crossattention.output", size)?,
            })
        };
        Ok(Self {
            qkv: weights.sub("attention.attention").linears(&["query", "key", "value"], size, size)?,
            own: output("attention.output", size)?,
            cross: if has_cross { Some(cross()?) } else { None },
            wide: weights.linear("intermediate_query.dense", size, inner)?,
            narrow: output("output_query", inner)?,
            heads: config.num_attention_heads,
            activation: config.hidden_act,
        })
    }

    fn of(&self, x: &Tensor, states: &Tensor) -> Result<Tensor> {
        let size = x.dim(2)?;
        let scale = 1.0 / ((size / self.heads) as f32).sqrt();
        let attention = Attention { heads: self.heads, scale, bias: None };
        let qkv = self.qkv.of(x)?;
        let part = |at: usize| qkv.narrow(2, at * size, size);
        let mut x = self.own.of(&attention.of(&part(0)?, &part(1)?, &part(2)?)?, x)?;
        if let Some(cross) = &self.cross {
            let keys_values = cross.keys_values.of(states)?;
            let (keys, values) = (keys_values.narrow(2, 0, size)?, keys_values.narrow(2, size, size)?);
            x = cross.output.of(&attention.of(&cross.query.of(&x)?, &keys, &values)?, &x)?;
        }
        self.narrow.of(&self.wide.of_then(&x, self.activation)?, &x)
    }
}

impl Output {
    fn of(&self, x: &Tensor, before: &Tensor) -> Result<Tensor> {
        self.norm.of(&(self.dense.of(x)? + before)?)
    }
}

//! The transformer layers of both towers (transformers' `CLIPEncoder`), with a norm before each sublayer and a residual
//! around it.

use super::config::LayersConfig;
use crate::{
    LocalError,
    ops::{Activation, FeedForward, LayerNorm, LinearLayer, MultiHeadAttention},
    weights::WeightScope,
};
use candle_core::{Result, Tensor};

/// A stack of layers that computes the states of all tokens, or of one token of each text or picture.
pub(crate) struct ClipLayers {
    /// All layers before the last one.
    before: Vec<ClipLayer>,
    last: ClipLayer,
}

/// One layer: a norm and attention among the tokens, then a norm and a feed-forward network.
struct ClipLayer {
    attention_norm: LayerNorm,
    /// The layer for queries, keys and values, side by side.
    qkv: LinearLayer,
    /// The layer behind the attention.
    mixed: LinearLayer,
    feed_forward_norm: LayerNorm,
    wide: LinearLayer,
    narrow: LinearLayer,
    heads: usize,
    activation: Activation,
}

impl ClipLayers {
    /// The layers 0, 1, .. of a part of a checkpoint.
    pub(crate) fn from_weights(
        weights: &WeightScope<'_>,
        config: &LayersConfig,
    ) -> std::result::Result<Self, LocalError> {
        let layer = |at: usize| ClipLayer::from_weights(&weights.sub_scope(at), config);
        let last = config.num_hidden_layers.saturating_sub(1);
        Ok(Self { before: (0..last).map(layer).collect::<std::result::Result<_, _>>()?, last: layer(last)? })
    }

    /// The states of all tokens x [batch, length, size], with a mask [length, length].
    pub(crate) fn apply_to_all(&self, x: Tensor, mask: Option<&Tensor>) -> Result<Tensor> {
        self.before.iter().chain([&self.last]).try_fold(x, |x, layer| layer.apply_to_all(&x, mask))
    }

    /// The state [batch, 1, size] of one token `at` of each text or picture in x [batch, length, size], with a mask
    /// [length, length]. The last layer computes only this state, which saves most of its work.
    pub(crate) fn states_at(&self, x: Tensor, mask: Option<&Tensor>, at: &[u32]) -> Result<Tensor> {
        let x = self.before.iter().try_fold(x, |x, layer| layer.apply_to_all(&x, mask))?;
        let (batch, length, size) = x.dims3()?;
        let place = |(text, at): (usize, &u32)| (text * length) as u32 + at;
        let rows = Tensor::from_vec(at.iter().enumerate().map(place).collect(), batch, x.device())?;
        let pick_rows = |x: &Tensor| {
            let width = x.dim(2)?;
            x.contiguous()?.reshape((batch * length, width))?.index_select(&rows, 0)?.reshape((batch, 1, width))
        };
        let mask = mask.map(|mask| {
            let at = Tensor::new(at, x.device())?;
            mask.index_select(&at, 0)?.reshape((batch, 1, 1, length))
        });
        let qkv = self.last.qkv.apply_to_normed(&x, &self.last.attention_norm)?;
        let q = pick_rows(&qkv)?.narrow(2, 0, size)?;
        self.last.apply_to(&pick_rows(&x)?, &qkv, &q, mask.transpose()?.as_ref())
    }
}

/// The queries (`at` 0), keys (1) or values (2) of a tensor that has them side by side.
fn qkv_part(qkv: &Tensor, at: usize) -> Result<Tensor> {
    let size = qkv.dim(2)? / 3;
    qkv.narrow(2, at * size, size)
}

impl ClipLayer {
    fn from_weights(weights: &WeightScope<'_>, config: &LayersConfig) -> std::result::Result<Self, LocalError> {
        let (size, inner, epsilon) = (config.hidden_size, config.intermediate_size, config.layer_norm_eps);
        Ok(Self {
            attention_norm: weights.read_layer_norm("layer_norm1", size, epsilon)?,
            qkv: weights.sub_scope("self_attn").read_joined_linears(&["q_proj", "k_proj", "v_proj"], size, size)?,
            mixed: weights.read_linear("self_attn.out_proj", size, size)?,
            feed_forward_norm: weights.read_layer_norm("layer_norm2", size, epsilon)?,
            wide: weights.read_linear("mlp.fc1", size, inner)?,
            narrow: weights.read_linear("mlp.fc2", inner, size)?,
            heads: config.num_attention_heads,
            activation: config.hidden_act,
        })
    }

    /// The layer's output for all tokens x [batch, length, size].
    fn apply_to_all(&self, x: &Tensor, mask: Option<&Tensor>) -> Result<Tensor> {
        let qkv = self.qkv.apply_to_normed(x, &self.attention_norm)?;
        self.apply_to(x, &qkv, &qkv_part(&qkv, 0)?, mask)
    }

    /// The layer's output for x [batch, queries, size]. `q` are the queries of x, and `qkv` has the keys and values of
    /// all tokens.
    fn apply_to(&self, x: &Tensor, qkv: &Tensor, q: &Tensor, mask: Option<&Tensor>) -> Result<Tensor> {
        let scale = 1.0 / ((x.dim(2)? / self.heads) as f32).sqrt();
        let attention = MultiHeadAttention { heads: self.heads, scale, bias: mask };
        let mixed = attention.attend_to(q, &qkv_part(qkv, 1)?, &qkv_part(qkv, 2)?)?;
        let feed_forward = FeedForward {
            before: Some(&self.feed_forward_norm),
            wide: &self.wide,
            activation: self.activation,
            narrow: &self.narrow,
            after: None,
        };
        feed_forward.apply_to(&self.mixed.apply_and_add(&mixed, x)?)
    }
}

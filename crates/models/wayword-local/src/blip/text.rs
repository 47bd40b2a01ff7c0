//! BLIP's text model: a BERT with a second attention in each layer. In the encoder and in the describing decoder it looks
//! at the picture, in the answering decoder at the encoder's states of the question.

use super::config::TextConfig;
use crate::{
    LocalError,
    ops::{Activation, Attention, Embedding, LayerNorm, Linear, Past, causal},
    weights::Scope,
};
use candle_core::{Result, Tensor};

/// Computes a state for each token of a text.
pub(super) struct TextModel {
    words: Embedding,
    positions: Embedding,
    norm: LayerNorm,
    layers: Vec<Layer>,
}

/// The keys and values, layer by layer, of the states that tokens attend to. They are computed once.
pub(super) type Attended = Vec<(Tensor, Tensor)>;

struct Layer {
    own: Own,
    cross_query: Linear,
    cross_keys_values: Linear,
    cross: Output,
    wide: Linear,
    narrow: Output,
    heads: usize,
    activation: Activation,
}

/// Attention among the tokens themselves.
struct Own {
    qkv: Linear,
    output: Output,
}

/// A linear layer with a residual: its output is added to an earlier state, and a norm follows.
struct Output {
    dense: Linear,
    norm: LayerNorm,
}

impl TextModel {
    pub(super) fn load(weights: &Scope<'_>, config: &TextConfig) -> std::result::Result<Self, LocalError> {
        let size = config.hidden_size;
        let embeddings = weights.sub("embeddings");
        let layers =
            (0..config.num_hidden_layers).map(|layer| Layer::load(&weights.sub("encoder.layer").sub(layer), config));
        Ok(Self {
            words: embeddings.embedding("word_embeddings", config.vocab_size, size)?,
            positions: embeddings.embedding("position_embeddings", config.max_position_embeddings, size)?,
            norm: embeddings.layer_norm("LayerNorm", size, config.layer_norm_eps)?,
            layers: layers.collect::<std::result::Result<_, _>>()?,
        })
    }

    /// The keys and values of states [1, count, size] that tokens will attend to.
    pub(super) fn attended(&self, states: &Tensor) -> Result<Attended> {
        let keys_values = |layer: &Layer| {
            let both = layer.cross_keys_values.of(states)?;
            let size = both.dim(2)? / 2;
            Ok((both.narrow(2, 0, size)?, both.narrow(2, size, size)?))
        };
        self.layers.iter().map(keys_values).collect()
    }

    /// The states [1, length, size] of a whole text [1, length]. Each token sees all others.
    pub(super) fn read(&self, ids: &Tensor, attended: &Attended) -> Result<Tensor> {
        let x = self.embedded(ids, 0)?;
        self.layers
            .iter()
            .zip(attended)
            .try_fold(x, |x, (layer, attended)| layer.of(&x, attended, None, &mut Past::default()))
    }

    /// The empty cache before the first token, layer by layer.
    pub(super) fn past(&self) -> Vec<Past> {
        vec![Past::default(); self.layers.len()]
    }

    /// The states [1, length, size] of the next tokens [1, length] after those of `past`. Each sees the tokens before
    /// it.
    pub(super) fn go_on(&self, ids: &Tensor, attended: &Attended, past: &mut [Past]) -> Result<Tensor> {
        let before = past.first().map_or(Ok(0), Past::len)?;
        let length = ids.dim(1)?;
        let mask = if length > 1 { Some(causal(length, before + length, ids.device())?) } else { None };
        let mut x = self.embedded(ids, before)?;
        for ((layer, attended), past) in self.layers.iter().zip(attended).zip(past) {
            x = layer.of(&x, attended, mask.as_ref(), past)?;
        }
        Ok(x)
    }

    fn embedded(&self, ids: &Tensor, before: usize) -> Result<Tensor> {
        let (from, to) = (before as u32, (before + ids.dim(1)?) as u32);
        let positions = self.positions.of(&Tensor::arange(from, to, ids.device())?)?;
        self.norm.of(&self.words.of(ids)?.broadcast_add(&positions)?)
    }
}

impl Layer {
    fn load(weights: &Scope<'_>, config: &TextConfig) -> std::result::Result<Self, LocalError> {
        let (size, inner, epsilon) = (config.hidden_size, config.intermediate_size, config.layer_norm_eps);
        let output = |name: &str, inputs: usize| -> std::result::Result<Output, LocalError> {
            let layer = weights.sub(name);
            Ok(Output {
                dense: layer.linear("dense", inputs, size)?,
                norm: layer.layer_norm("LayerNorm", size, epsilon)?,
            })
        };
        let cross = weights.sub("crossattention.self");
        Ok(Self {
            own: Own {
                qkv: weights.sub("attention.self").linears(&["query", "key", "value"], size, size)?,
                output: output("attention.output", size)?,
            },
            cross_query: cross.linear("query", size, size)?,
            cross_keys_values: cross.linears(&["key", "value"], config.encoder_hidden_size, size)?,
            cross: output("crossattention.output", size)?,
            wide: weights.linear("intermediate.dense", size, inner)?,
            narrow: output("output", inner)?,
            heads: config.num_attention_heads,
            activation: config.hidden_act,
        })
    }

    fn of(&self, x: &Tensor, attended: &(Tensor, Tensor), mask: Option<&Tensor>, past: &mut Past) -> Result<Tensor> {
        let size = x.dim(2)?;
        let scale = 1.0 / ((size / self.heads) as f32).sqrt();
        let qkv = self.own.qkv.of(x)?;
        let part = |at: usize| qkv.narrow(2, at * size, size);
        let (keys, values) = past.grow(part(1)?, part(2)?)?;
        let mixed = Attention { heads: self.heads, scale, bias: mask }.of(&part(0)?, &keys, &values)?;
        let x = self.own.output.of(&mixed, x)?;
        let seen = Attention { heads: self.heads, scale, bias: None };
        let x = self.cross.of(&seen.of(&self.cross_query.of(&x)?, &attended.0, &attended.1)?, &x)?;
        self.narrow.of(&self.wide.of_then(&x, self.activation)?, &x)
    }
}

impl Output {
    fn of(&self, x: &Tensor, before: &Tensor) -> Result<Tensor> {
        self.norm.of(&(self.dense.of(x)? + before)?)
    }
}

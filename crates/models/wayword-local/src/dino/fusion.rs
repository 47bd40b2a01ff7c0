//! Attention between a picture and a text, in both directions at once.
//!
//! A picture has thousands of cells, and a prompt has a few tokens. So the linear layers of the cells are applied to
//! the tokens instead. For a cell `v` and a key `k`, the score is `(W v + b) . k = v . (Wᵀ k) + b . k`: only `Wᵀ k`
//! needs a product with the matrix, once per token. Values are treated alike: those of tokens are projected before
//! cells mix them, and those of cells after tokens mixed them. The numbers are the same, for a tenth of the work.

use super::config::DinoConfig;
use crate::{
    LocalError,
    ops::{
        LayerNorm, LinearLayer,
        matrix::{multiply_matrices, softmax_rows},
    },
    weights::WeightScope,
};
use candle_core::{Result, Tensor};

/// The fusion of one layer of the encoder. The residual is the *normalised* states, and not the states themselves.
pub(super) struct DinoFusion {
    vision_norm: LayerNorm,
    text_norm: LayerNorm,
    /// Computes keys and values of the tokens, side by side.
    text: LinearLayer,
    /// The layer of the cells' queries: [heads, head size, size] and [heads, head size, 1].
    query: Tensor,
    query_bias: Tensor,
    /// The output layer of the cells, times `vision_param`: [heads, head size, size] and [size].
    out: Tensor,
    out_bias: Tensor,
    /// The layer of the cells' values: [heads, size, head size] and [heads, 1, head size].
    value: Tensor,
    value_bias: Tensor,
    /// The output layer of the tokens, and the factor (`text_param`) for its output.
    text_out: LinearLayer,
    text_share: Tensor,
    heads: usize,
    scale: f64,
}

impl DinoFusion {
    pub(super) fn from_weights(
        weights: &WeightScope<'_>,
        config: &DinoConfig,
    ) -> std::result::Result<Self, LocalError> {
        let (size, width, heads) = (config.size, config.encoder.inner / 2, config.encoder.heads / 2);
        let head_size = width / heads;
        let attn = weights.sub_scope("attn");
        let wrong = |name: &str, error| attn.tensor_error(name, &error);
        let weight = |name: &str, shape: &[usize]| attn.read_state(&format!("{name}.weight"), shape);
        let bias = |name: &str, count: usize| attn.read_state(&format!("{name}.bias"), &[count]);
        let share = weights.read_state("vision_param", &[size])?;
        let query = weight("vision_proj", &[width, size])?.reshape((heads, head_size, size));
        let query_bias = bias("vision_proj", width)?.reshape((heads, head_size, 1));
        let out = weight("out_vision_proj", &[size, width])?;
        let out = out.t().and_then(|out| out.broadcast_mul(&share)?.reshape((heads, head_size, size)));
        let out_bias = bias("out_vision_proj", size)? * &share;
        let value = weight("values_vision_proj", &[width, size])?;
        let value = value.reshape((heads, head_size, size)).and_then(|value| value.transpose(1, 2)?.contiguous());
        let value_bias = bias("values_vision_proj", width)?.reshape((heads, 1, head_size));
        Ok(Self {
            vision_norm: weights.read_layer_norm("layer_norm_vision", size, config.epsilon)?,
            text_norm: weights.read_layer_norm("layer_norm_text", size, config.epsilon)?,
            text: attn.read_joined_linears(&["text_proj", "values_text_proj"], size, width)?,
            query: query.map_err(|error| wrong("vision_proj.weight", error))?,
            query_bias: query_bias.map_err(|error| wrong("vision_proj.bias", error))?,
            out: out.map_err(|error| wrong("out_vision_proj.weight", error))?,
            out_bias: out_bias.map_err(|error| wrong("out_vision_proj.bias", error))?,
            value: value.map_err(|error| wrong("values_vision_proj.weight", error))?,
            value_bias: value_bias.map_err(|error| wrong("values_vision_proj.bias", error))?,
            text_out: attn.read_linear("out_text_proj", width, size)?,
            text_share: weights.read_state("text_param", &[size])?,
            heads,
            scale: 1.0 / (head_size as f64).sqrt(),
        })
    }

    /// The fused states of cells [1, cells, size] and tokens [1, tokens, size].
    pub(super) fn fuse_states(&self, vision: &Tensor, text: &Tensor) -> Result<(Tensor, Tensor)> {
        // v: the cells (vision), l: the tokens (language).
        let (v, l) = (self.vision_norm.apply_to(vision)?, self.text_norm.apply_to(text)?);
        let (cells, tokens, size) = (v.dim(1)?, l.dim(1)?, v.dim(2)?);
        let both = self.text.apply_to(&l)?;
        let width = both.dim(2)? / 2;
        let part = |at: usize| {
            let part = both.narrow(2, at * width, width)?;
            part.reshape((tokens, self.heads, width / self.heads))?.transpose(0, 1)?.contiguous()
        };
        // Scores of all heads side by side, [cells, heads * tokens].
        let keys = (part(0)? * self.scale)?;
        let rows = keys.matmul(&self.query)?.reshape((self.heads * tokens, size))?;
        let bias = keys.matmul(&self.query_bias)?.flatten_all()?;
        let scores = LinearLayer::new(&rows, Some(bias))?.apply_to(&v)?.reshape((cells, self.heads * tokens))?;
        // A softmax over all cells, and the mix of cells for each token.
        let over_cells = softmax_rows(&scores.t()?.contiguous()?)?;
        let pooled = multiply_matrices(&over_cells, &v.squeeze(0)?)?.reshape((self.heads, tokens, size))?;
        let pooled = pooled.matmul(&self.value)?.broadcast_add(&self.value_bias)?;
        let pooled = pooled.transpose(0, 1)?.reshape((1, tokens, width))?;
        let l = (l + self.text_out.apply_to(&pooled)?.broadcast_mul(&self.text_share)?)?;
        // A softmax over the tokens of each head, and the mix of tokens for each cell.
        let over_tokens = softmax_rows(&scores.reshape((cells * self.heads, tokens))?)?;
        let values = part(1)?.matmul(&self.out)?.reshape((self.heads * tokens, size))?;
        let mixed = LinearLayer::new(&values.t()?.contiguous()?, Some(self.out_bias.clone()))?;
        let v = (v + mixed.apply_to(&over_tokens.reshape((1, cells, self.heads * tokens))?)?)?;
        Ok((v, l))
    }
}

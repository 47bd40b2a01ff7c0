//! The fusion of picture and text: each attends to the other.
//!
//! A picture has thousands of positions, and a text has a few tokens. So the linear layers of the picture's side are
//! applied to the tokens instead. For a head, (W v + b) . k = v . (Wᵀ k) + b . k. And since attention weights sum to 1,
//! values may be projected after they are mixed. Both are exact, and need a tenth of the multiplications.

use super::config::HeadConfig;
use crate::{
    LocalError,
    ops::{
        LayerNorm, LinearLayer,
        matrix::{add_product, multiply_matrices, softmax_rows},
    },
    weights::WeightScope,
};
use candle_core::{D, Result, Tensor};

/// Added to variances, so that no division is by 0.
const NORM_EPSILON: f64 = 1e-5;

/// The most columns of scores at a time. With a long text these are the columns of a few heads.
const MAX_SCORE_COLUMNS: usize = 512;

/// The fusion of one round of the head. In the names of fields, `v` is the picture (vision) and `l` the text
/// (language).
pub(super) struct GlipFusion {
    norm_v: LayerNorm,
    norm_l: LayerNorm,
    /// The factors for what the fusion adds to the picture and to the text.
    gamma_v: Tensor,
    gamma_l: Tensor,
    /// The layer of the picture's queries: [heads, size, width] and [heads, size, 1].
    query: (Tensor, Tensor),
    key: LinearLayer,
    values_l: LinearLayer,
    /// [heads, size, width] and [heads, 1, size]: the layer of the picture's values, transposed for each head.
    values_v: (Tensor, Tensor),
    /// [heads, size, width] and [width]: the output of each head, transposed.
    out_v: (Tensor, Tensor),
    out_l: LinearLayer,
    heads: usize,
    /// The width of a head.
    size: usize,
}

impl GlipFusion {
    /// Reads the fusion. `text` is the width of the states of the text.
    pub(super) fn from_weights(
        weights: &WeightScope<'_>,
        config: &HeadConfig,
        text: usize,
    ) -> std::result::Result<Self, LocalError> {
        let (heads, size, width) = (config.fusion_heads, config.fusion_width, config.width);
        let (inner, attn) = (heads * size, weights.sub_scope("attn"));
        let pair = |name: &str, shape: [usize; 2]| {
            let part = attn.sub_scope(name);
            Ok::<_, LocalError>((part.read_state("weight", &shape)?, part.read_state("bias", &shape[..1])?))
        };
        let wrong = |error: candle_core::Error| attn.tensor_error("", &error);
        let (query, query_bias) = pair("v_proj", [inner, width])?;
        let (values, values_bias) = pair("values_v_proj", [inner, width])?;
        let (out, out_bias) = pair("out_v_proj", [width, inner])?;
        let by_head = |weight: &Tensor| weight.reshape((heads, size, width)).map_err(wrong);
        Ok(Self {
            norm_v: weights.read_layer_norm("layer_norm_v", width, NORM_EPSILON)?,
            norm_l: weights.read_layer_norm("layer_norm_l", text, NORM_EPSILON)?,
            gamma_v: weights.read_state("gamma_v", &[width])?,
            gamma_l: weights.read_state("gamma_l", &[text])?,
            query: (by_head(&query)?, query_bias.reshape((heads, size, 1)).map_err(wrong)?),
            key: attn.read_linear("l_proj", text, inner)?,
            values_l: attn.read_linear("values_l_proj", text, inner)?,
            values_v: (by_head(&values)?, values_bias.reshape((heads, 1, size)).map_err(wrong)?),
            out_v: (by_head(&out.t().and_then(|out| out.contiguous()).map_err(wrong)?)?, out_bias),
            out_l: attn.read_linear("out_l_proj", inner, text)?,
            heads,
            size,
        })
    }

    /// The new features of positions [positions, width] and of tokens [tokens, text].
    pub(super) fn fuse_states(&self, vision: &Tensor, text: &Tensor) -> Result<(Tensor, Tensor)> {
        let (v, l) = (self.norm_v.apply_to(vision)?, self.norm_l.apply_to(text)?);
        let tokens = l.dim(0)?;
        let split = |x: Tensor| x.reshape((tokens, self.heads, self.size))?.transpose(0, 1)?.contiguous();
        let scale = 1.0 / (self.size as f64).sqrt();
        // [heads, tokens, size]
        let keys = (split(self.key.apply_to(&l)?)? * scale)?;
        // The features of a position are multiplied with `folded` [heads, tokens, width], then `added` [heads, tokens,
        // 1] is added.
        let folded = keys.matmul(&self.query.0)?;
        let added = keys.matmul(&self.query.1)?;
        // The values of the tokens, already multiplied by the output layer and by `gamma_v`.
        let outputs = split(self.values_l.apply_to(&l)?)?.matmul(&self.out_v.0)?.broadcast_mul(&self.gamma_v)?;
        let bias = (&self.out_v.1 * &self.gamma_v)?;
        // The residuals begin from the normed features.
        let mut new_v = v.clone();
        let mut pooled = Vec::new();
        let heads_at_a_time = (MAX_SCORE_COLUMNS / tokens.max(1)).clamp(1, self.heads);
        for begin in (0..self.heads).step_by(heads_at_a_time) {
            let heads = heads_at_a_time.min(self.heads - begin);
            let take_heads = |x: &Tensor| x.narrow(0, begin, heads)?.flatten_to(1);
            let folded = take_heads(&folded)?;
            // A number that is the same for all positions does not change a softmax over them, so `added` is left out.
            let to_text = softmax_rows(&multiply_matrices(&folded, &v.t()?)?)?;
            pooled.push(multiply_matrices(&to_text, &v)?.reshape((heads, tokens, v.dim(1)?))?);
            let added = take_heads(&added)?.reshape((1, heads * tokens))?;
            let scores = multiply_matrices(&v, &folded.t()?)?.broadcast_add(&added)?;
            let to_vision = softmax_rows(&scores.reshape((v.dim(0)?, heads, tokens))?)?.flatten_from(1)?;
            new_v = add_product(&new_v, &to_vision, &take_heads(&outputs)?, (begin == 0).then_some(&bias))?;
        }
        let mixed = Tensor::cat(&pooled, 0)?.matmul(&self.values_v.0.transpose(1, D::Minus1)?.contiguous()?)?;
        let mixed = mixed.broadcast_add(&self.values_v.1)?.transpose(0, 1)?.contiguous()?.flatten_from(1)?;
        let to_l = self.out_l.apply_to(&mixed)?;
        Ok((new_v, (l + to_l.broadcast_mul(&self.gamma_l)?)?))
    }
}

//! The parts that the encoder's and the decoder's layers have in common: attention, feed-forward layers, and a
//! perceptron.

use super::LoadResult;
use crate::{
    ops::{
        Activation, LayerNorm, LinearLayer, MultiHeadAttention,
        kernels::{is_cpu_f32, with_f32_slice},
        tiles::{each_tile, split_memory},
    },
    weights::WeightScope,
};
use candle_core::{Result, Tensor};

/// The width of a part of a wide layer, numbers. Rows that are much longer, at distances of a power of 2, would fall
/// into the same lines of the processor's cache and push each other out.
const PART_WIDTH: usize = 256;

/// Multi-head attention with layers for queries, keys, values and the result.
pub(super) struct ProjectedAttention {
    query: LinearLayer,
    key: LinearLayer,
    value: LinearLayer,
    out: LinearLayer,
    heads: usize,
    scale: f32,
}

/// A wide layer, an activation, a narrow layer, and a norm of the sum with the input.
pub(super) struct NormedFeedForward {
    /// The two layers, split along the width between them into parts that fit into the processor's cache.
    parts: Vec<(LinearLayer, LinearLayer)>,
    /// The width between the two layers of a part.
    width: usize,
    norm: LayerNorm,
    activation: Activation,
}

/// Linear layers with a ReLU between them.
pub(super) struct ReluPerceptron(Vec<LinearLayer>);

impl ProjectedAttention {
    pub(super) fn from_weights(weights: &WeightScope<'_>, size: usize, heads: usize) -> LoadResult<Self> {
        let layer = |name: &str| weights.read_linear(name, size, size);
        Ok(Self {
            query: layer("query")?,
            key: layer("key")?,
            value: layer("value")?,
            out: layer("out_proj")?,
            heads,
            scale: 1.0 / ((size / heads) as f32).sqrt(),
        })
    }

    /// The mix of values for each query, [1, queries, size]. `bias` is added to the scores.
    pub(super) fn attend_to(
        &self,
        queries: &Tensor,
        keys: &Tensor,
        values: &Tensor,
        bias: Option<&Tensor>,
    ) -> Result<Tensor> {
        let (q, k, v) = (self.query.apply_to(queries)?, self.key.apply_to(keys)?, self.value.apply_to(values)?);
        self.out.apply_to(&MultiHeadAttention { heads: self.heads, scale: self.scale, bias }.attend_to(&q, &k, &v)?)
    }
}

impl NormedFeedForward {
    /// Reads the layers `fc1` and `fc2`, and the norm with the name `norm`.
    pub(super) fn from_weights(
        weights: &WeightScope<'_>,
        norm: &str,
        (size, inner): (usize, usize),
        activation: Activation,
        epsilon: f64,
    ) -> LoadResult<Self> {
        let (first, second) = (weights.sub_scope("fc1"), weights.sub_scope("fc2"));
        let (wide, wide_bias) = (first.read_tensor("weight", &[inner, size])?, first.read_tensor("bias", &[inner])?);
        let (narrow, narrow_bias) =
            (second.read_tensor("weight", &[size, inner])?, second.read_tensor("bias", &[size])?);
        let width = if wide.device().is_cpu() && inner.is_multiple_of(PART_WIDTH) { PART_WIDTH } else { inner };
        let part = |from: usize| -> Result<(LinearLayer, LinearLayer)> {
            let bias = if from == 0 { Some(narrow_bias.clone()) } else { None };
            let wide = LinearLayer::new(&wide.narrow(0, from, width)?, Some(wide_bias.narrow(0, from, width)?))?;
            Ok((wide, LinearLayer::new(&narrow.narrow(1, from, width)?.contiguous()?, bias)?))
        };
        let parts = (0..inner).step_by(width).map(part).collect::<Result<_>>();
        Ok(Self {
            parts: parts.map_err(|error| first.tensor_error("weight", &error))?,
            width,
            norm: weights.read_layer_norm(norm, size, epsilon)?,
            activation,
        })
    }

    /// The output for x [1, rows, size].
    pub(super) fn apply_to(&self, x: &Tensor) -> Result<Tensor> {
        if is_cpu_f32(x) {
            return self.apply_on_cpu(x);
        }
        let part = |sum: Tensor, (wide, narrow): &(LinearLayer, LinearLayer)| {
            sum + narrow.apply_to(&wide.apply_and_activate(x, self.activation)?)?
        };
        self.norm.apply_to(&self.parts.iter().try_fold(x.clone(), part)?)
    }

    /// Takes a tile of rows at a time through both layers, so that the numbers between them stay in the processor's
    /// cache.
    fn apply_on_cpu(&self, x: &Tensor) -> Result<Tensor> {
        let (_, count, size) = x.dims3()?;
        let mut y = vec![0.0; count * size];
        with_f32_slice(x, |x| {
            each_tile(&mut y, size, |from, y, memory| {
                let rows = y.len() / size;
                let x = &x[from * size..(from + rows) * size];
                let [between, sum] = split_memory(memory, [rows * self.width, rows * size]);
                sum.copy_from_slice(x);
                for (wide, narrow) in &self.parts {
                    wide.write_rows(x, between)?;
                    self.activation.map_on_this_thread(between);
                    narrow.add_rows(between, sum)?;
                }
                self.norm.write_rows(sum, y)
            })
        })?;
        Tensor::from_vec(y, (1, count, size), x.device())
    }
}

impl ReluPerceptron {
    /// The layers `layers.0`, `layers.1`, .. between these widths.
    pub(super) fn from_weights(weights: &WeightScope<'_>, widths: &[usize]) -> LoadResult<Self> {
        let layers = weights.sub_scope("layers");
        let layer = |(at, ends): (usize, &[usize])| layers.read_linear(&at.to_string(), ends[0], ends[1]);
        widths.windows(2).enumerate().map(layer).collect::<LoadResult<_>>().map(Self)
    }

    pub(super) fn apply_to(&self, x: &Tensor) -> Result<Tensor> {
        let Some((last, before)) = self.0.split_last() else { return Ok(x.clone()) };
        last.apply_to(&before.iter().try_fold(x.clone(), |x, layer| layer.apply_and_activate(&x, Activation::Relu))?)
    }
}

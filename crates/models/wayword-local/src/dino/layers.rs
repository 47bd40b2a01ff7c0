//! The parts that the encoder's and the decoder's layers have in common: attention, feed-forward layers, and a
//! perceptron.

use crate::{
    LocalError,
    ops::{
        Activation, Attention, LayerNorm, Linear,
        kernels::{is_ours, with_numbers},
        tiles::{each_tile, room},
    },
    weights::Scope,
};
use candle_core::{Result, Tensor};

type Loaded<T> = std::result::Result<T, LocalError>;

/// The width of a part of a wide layer. Rows that are much longer, at distances of a power of 2, would fall into the
/// same lines of the processor's cache and push each other out.
const PART: usize = 256;

/// Multi-head attention with layers for queries, keys, values and the result.
pub(super) struct Mixing {
    query: Linear,
    key: Linear,
    value: Linear,
    out: Linear,
    heads: usize,
    scale: f32,
}

/// A wide layer, an activation, a narrow layer, and a norm of the sum with the input.
pub(super) struct Feed {
    /// The two layers, split along the width between them into parts that fit into the processor's cache.
    parts: Vec<(Linear, Linear)>,
    /// The width between the two layers of a part.
    width: usize,
    norm: LayerNorm,
    activation: Activation,
}

/// Linear layers with a ReLU between them.
pub(super) struct Perceptron(Vec<Linear>);

impl Mixing {
    pub(super) fn load(weights: &Scope<'_>, size: usize, heads: usize) -> Loaded<Self> {
        let layer = |name: &str| weights.linear(name, size, size);
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
    pub(super) fn of(&self, queries: &Tensor, keys: &Tensor, values: &Tensor, bias: Option<&Tensor>) -> Result<Tensor> {
        let (q, k, v) = (self.query.of(queries)?, self.key.of(keys)?, self.value.of(values)?);
        self.out.of(&Attention { heads: self.heads, scale: self.scale, bias }.of(&q, &k, &v)?)
    }
}

impl Feed {
    /// Reads the layers `fc1` and `fc2`, and the norm with the name `norm`.
    pub(super) fn load(
        weights: &Scope<'_>,
        norm: &str,
        (size, inner): (usize, usize),
        activation: Activation,
        epsilon: f64,
    ) -> Loaded<Self> {
        let (first, second) = (weights.sub("fc1"), weights.sub("fc2"));
        let (wide, wide_bias) = (first.tensor("weight", &[inner, size])?, first.tensor("bias", &[inner])?);
        let (narrow, narrow_bias) = (second.tensor("weight", &[size, inner])?, second.tensor("bias", &[size])?);
        let width = if wide.device().is_cpu() && inner.is_multiple_of(PART) { PART } else { inner };
        let part = |from: usize| -> Result<(Linear, Linear)> {
            let bias = if from == 0 { Some(narrow_bias.clone()) } else { None };
            let wide = Linear::new(&wide.narrow(0, from, width)?, Some(wide_bias.narrow(0, from, width)?))?;
            Ok((wide, Linear::new(&narrow.narrow(1, from, width)?.contiguous()?, bias)?))
        };
        let parts = (0..inner).step_by(width).map(part).collect::<Result<_>>();
        Ok(Self {
            parts: parts.map_err(|error| first.wrong("weight", &error))?,
            width,
            norm: weights.layer_norm(norm, size, epsilon)?,
            activation,
        })
    }

    /// The output for x [1, rows, size].
    pub(super) fn of(&self, x: &Tensor) -> Result<Tensor> {
        if is_ours(x) {
            return self.on_processor(x);
        }
        let part =
            |sum: Tensor, (wide, narrow): &(Linear, Linear)| sum + narrow.of(&wide.of_then(x, self.activation)?)?;
        self.norm.of(&self.parts.iter().try_fold(x.clone(), part)?)
    }

    /// Takes a tile of rows at a time through both layers, so that the numbers between them stay in the processor's
    /// cache.
    fn on_processor(&self, x: &Tensor) -> Result<Tensor> {
        let (_, count, size) = x.dims3()?;
        let mut y = vec![0.0; count * size];
        with_numbers(x, |x| {
            each_tile(&mut y, size, |from, y, memory| {
                let rows = y.len() / size;
                let x = &x[from * size..(from + rows) * size];
                let [between, sum] = room(memory, [rows * self.width, rows * size]);
                sum.copy_from_slice(x);
                for (wide, narrow) in &self.parts {
                    wide.rows(x, between)?;
                    self.activation.map_here(between);
                    narrow.add_rows(between, sum)?;
                }
                self.norm.rows(sum, y)
            })
        })?;
        Tensor::from_vec(y, (1, count, size), x.device())
    }
}

impl Perceptron {
    /// The layers `layers.0`, `layers.1`, .. between these widths.
    pub(super) fn load(weights: &Scope<'_>, widths: &[usize]) -> Loaded<Self> {
        let layers = weights.sub("layers");
        let layer = |(at, ends): (usize, &[usize])| layers.linear(&at.to_string(), ends[0], ends[1]);
        widths.windows(2).enumerate().map(layer).collect::<Loaded<_>>().map(Self)
    }

    pub(super) fn of(&self, x: &Tensor) -> Result<Tensor> {
        let Some((last, before)) = self.0.split_last() else { return Ok(x.clone()) };
        last.of(&before.iter().try_fold(x.clone(), |x, layer| layer.of_then(&x, Activation::Relu))?)
    }
}

//! The small parts of which the layers are made.

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
    wide: Linear,
    narrow: Linear,
    norm: LayerNorm,
    activation: Activation,
    inner: usize,
}

/// Layers with a ReLU between them.
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

    /// States [1, queries, size] of queries, keys and values. `bias` is added to the scores.
    pub(super) fn of(&self, queries: &Tensor, keys: &Tensor, values: &Tensor, bias: Option<&Tensor>) -> Result<Tensor> {
        let (q, k, v) = (self.query.of(queries)?, self.key.of(keys)?, self.value.of(values)?);
        self.out.of(&Attention { heads: self.heads, scale: self.scale, bias }.of(&q, &k, &v)?)
    }
}

impl Feed {
    /// `fc1`, `fc2` and the norm of this name.
    pub(super) fn load(
        weights: &Scope<'_>,
        norm: &str,
        (size, inner): (usize, usize),
        activation: Activation,
        epsilon: f64,
    ) -> Loaded<Self> {
        Ok(Self {
            wide: weights.linear("fc1", size, inner)?,
            narrow: weights.linear("fc2", inner, size)?,
            norm: weights.layer_norm(norm, size, epsilon)?,
            activation,
            inner,
        })
    }

    /// Of x [1, rows, size].
    pub(super) fn of(&self, x: &Tensor) -> Result<Tensor> {
        if is_ours(x) {
            return self.on_processor(x);
        }
        let narrow = self.narrow.of(&self.wide.of_then(x, self.activation)?)?;
        self.norm.of(&(narrow + x)?)
    }

    /// By tiles of rows, so that what is between two layers stays in the processor's cache.
    fn on_processor(&self, x: &Tensor) -> Result<Tensor> {
        let (_, count, size) = x.dims3()?;
        let mut y = vec![0.0; count * size];
        with_numbers(x, |x| {
            each_tile(&mut y, size, |from, y, memory| {
                let rows = y.len() / size;
                let x = &x[from * size..(from + rows) * size];
                let [wide, narrow] = room(memory, [rows * self.inner, rows * size]);
                self.wide.rows(x, wide)?;
                self.activation.map_here(wide);
                self.narrow.rows(wide, narrow)?;
                narrow.iter_mut().zip(x).for_each(|(narrow, x)| *narrow += x);
                self.norm.rows(narrow, y)
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

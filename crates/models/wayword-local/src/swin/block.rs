//! A block of a Swin transformer: attention within windows, then two linear layers for each position. Both have a norm
//! before them and a residual around them.

use super::{
    attention::WindowAttention,
    config::{Names, SwinConfig},
    windows::Windows,
};
use crate::{
    LocalError,
    ops::{
        Activation, LayerNorm, Linear,
        kernels::{is_ours, with_numbers},
        tiles::{TILE, each_tile, room},
    },
    weights::Scope,
};
use candle_core::{Result, Tensor};

pub(super) struct Block {
    mix_norm: LayerNorm,
    qkv: Linear,
    /// The queries, keys and values of padding. Padding is 0, so they are the bias of the layer.
    of_padding: Tensor,
    attention: WindowAttention,
    mixed: Linear,
    think_norm: LayerNorm,
    wide: Linear,
    narrow: Linear,
    /// The width between the last two layers.
    inner: usize,
}

impl Block {
    pub(super) fn load(
        weights: &Scope<'_>,
        names: &Names,
        config: &SwinConfig,
        stage: usize,
    ) -> std::result::Result<Self, LocalError> {
        let (width, epsilon) = (config.width_of(stage), config.epsilon);
        let (inner, each) = (width * config.widening, 3 * width / names.qkv.len());
        let biases = names.qkv.iter().map(|layer| weights.sub(layer).state("bias", &[each]));
        let biases: Vec<Tensor> = biases.collect::<std::result::Result<_, _>>()?;
        let of_padding = Tensor::cat(&biases, 0).map_err(|error| weights.wrong(names.qkv[0], &error))?;
        Ok(Self {
            mix_norm: weights.layer_norm(names.mix_norm, width, epsilon)?,
            qkv: weights.linears(names.qkv, width, each)?,
            of_padding,
            attention: WindowAttention::load(weights, names.positions, config.heads[stage], config.window)?,
            mixed: weights.linear(names.mixed, width, width)?,
            think_norm: weights.layer_norm(names.think_norm, width, epsilon)?,
            wide: weights.linear(names.wide, width, inner)?,
            narrow: weights.linear(names.narrow, inner, width)?,
            inner,
        })
    }

    /// The block's output for x [batch, height, width, channels]. The shape stays the same.
    pub(super) fn of(&self, x: &Tensor, windows: &Windows) -> Result<Tensor> {
        let (batch, height, width, channels) = x.dims4()?;
        let one = |at: usize| {
            let x = x.get(at)?.reshape((height * width, channels))?;
            if is_ours(&x) { self.on_processor(&x, windows) } else { self.on_device(&x, windows) }
        };
        let all = (0..batch).map(one).collect::<Result<Vec<_>>>()?;
        Tensor::stack(&all, 0)?.reshape((batch, height, width, channels))
    }

    /// The output for x [positions, channels], with candle's operators.
    pub(super) fn on_device(&self, x: &Tensor, windows: &Windows) -> Result<Tensor> {
        let qkv = self.qkv.of(&self.mix_norm.of(x)?)?;
        let mixed = self.attention.on_device(&qkv, &self.of_padding, windows)?;
        let places = Tensor::from_slice(&windows.places, windows.places.len(), x.device())?;
        let x = (self.mixed.of(&mixed.index_select(&places, 0)?)? + x)?;
        let wide = self.wide.of_then(&self.think_norm.of(&x)?, Activation::Gelu)?;
        self.narrow.of(&wide)? + x
    }

    /// The output for x [positions, channels] on the processor. A tile of positions at a time goes through the layers,
    /// so that the numbers between two layers stay in the cache.
    fn on_processor(&self, x: &Tensor, windows: &Windows) -> Result<Tensor> {
        let (count, width) = x.dims2()?;
        let mut qkv = vec![0.0; count * 3 * width];
        with_numbers(x, |x| {
            each_tile(&mut qkv, 3 * width, |from, qkv, memory| {
                let rows = qkv.len() / (3 * width);
                let [normed] = room(memory, [rows * width]);
                self.mix_norm.rows(&x[from * width..(from + rows) * width], normed)?;
                self.qkv.rows(normed, qkv)
            })
        })?;
        let qkv = Tensor::from_vec(qkv, (count, 3 * width), x.device())?;
        let mixed = self.attention.on_processor(&qkv, &self.of_padding, windows)?;
        drop(qkv);
        let mut y = vec![0.0; count * width];
        with_numbers(x, |x| with_numbers(&mixed, |mixed| self.think(x, mixed, windows, &mut y)))?;
        Tensor::from_vec(y, (count, width), x.device())
    }

    /// The layers after attention. `mixed` is in the order of the windows, and is put back into the order of the map.
    fn think(&self, x: &[f32], mixed: &[f32], windows: &Windows, y: &mut [f32]) -> Result<()> {
        let width = x.len() / windows.places.len().max(1);
        each_tile(y, width, |from, y, memory| {
            let count = y.len();
            let [states, normed, wide] = room(memory, [count, count, TILE * self.inner]);
            let wide = &mut wide[..count / width * self.inner];
            for (normed, &place) in normed.chunks_exact_mut(width).zip(&windows.places[from..]) {
                normed.copy_from_slice(&mixed[place as usize * width..(place as usize + 1) * width]);
            }
            self.mixed.rows(normed, states)?;
            states.iter_mut().zip(&x[from * width..]).for_each(|(state, x)| *state += x);
            self.think_norm.rows(states, normed)?;
            self.wide.rows(normed, wide)?;
            Activation::Gelu.map_here(wide);
            self.narrow.rows(wide, y)?;
            y.iter_mut().zip(&*states).for_each(|(y, state)| *y += state);
            Ok(())
        })
    }
}

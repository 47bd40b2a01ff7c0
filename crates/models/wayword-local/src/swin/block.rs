//! A block of a Swin transformer: attention within windows, then two linear layers for each position. Both have a norm
//! before them and a residual around them.

use super::{
    attention::WindowAttention,
    config::{SwinConfig, SwinTensorNames},
    windows::MapWindows,
};
use crate::{
    LocalError,
    ops::{
        Activation, LayerNorm, LinearLayer,
        kernels::{is_cpu_f32, with_f32_slice},
        tiles::{TILE_ROWS, each_tile, split_memory},
    },
    weights::WeightScope,
};
use candle_core::{Result, Tensor};

/// A block: a norm and attention within windows, then a norm and two linear layers.
pub(super) struct SwinBlock {
    attention_norm: LayerNorm,
    qkv: LinearLayer,
    /// The queries, keys and values of padding. Padding is 0, so they are the bias of the layer.
    padding_qkv: Tensor,
    attention: WindowAttention,
    mixed: LinearLayer,
    feed_forward_norm: LayerNorm,
    wide: LinearLayer,
    narrow: LinearLayer,
    /// The width between the last two layers.
    inner: usize,
}

impl SwinBlock {
    pub(super) fn from_weights(
        weights: &WeightScope<'_>,
        names: &SwinTensorNames,
        config: &SwinConfig,
        stage: usize,
    ) -> std::result::Result<Self, LocalError> {
        let (width, epsilon) = (config.stage_width(stage), config.epsilon);
        let (inner, layer_width) = (width * config.widening, 3 * width / names.qkv.len());
        let biases = names.qkv.iter().map(|layer| weights.sub_scope(layer).read_state("bias", &[layer_width]));
        let biases: Vec<Tensor> = biases.collect::<std::result::Result<_, _>>()?;
        let of_padding = Tensor::cat(&biases, 0).map_err(|error| weights.tensor_error(names.qkv[0], &error))?;
        Ok(Self {
            attention_norm: weights.read_layer_norm(names.attention_norm, width, epsilon)?,
            qkv: weights.read_joined_linears(names.qkv, width, layer_width)?,
            padding_qkv: of_padding,
            attention: WindowAttention::from_weights(weights, names.positions, config.heads[stage], config.window)?,
            mixed: weights.read_linear(names.mixed, width, width)?,
            feed_forward_norm: weights.read_layer_norm(names.feed_forward_norm, width, epsilon)?,
            wide: weights.read_linear(names.wide, width, inner)?,
            narrow: weights.read_linear(names.narrow, inner, width)?,
            inner,
        })
    }

    /// The block's output for x [batch, height, width, channels]. The shape stays the same.
    pub(super) fn apply_to(&self, x: &Tensor, windows: &MapWindows) -> Result<Tensor> {
        let (batch, height, width, channels) = x.dims4()?;
        let apply_one = |at: usize| {
            let x = x.get(at)?.reshape((height * width, channels))?;
            if is_cpu_f32(&x) { self.apply_on_cpu(&x, windows) } else { self.apply_on_device(&x, windows) }
        };
        let all = (0..batch).map(apply_one).collect::<Result<Vec<_>>>()?;
        Tensor::stack(&all, 0)?.reshape((batch, height, width, channels))
    }

    /// The output for x [positions, channels], with candle's operators.
    pub(super) fn apply_on_device(&self, x: &Tensor, windows: &MapWindows) -> Result<Tensor> {
        let qkv = self.qkv.apply_to(&self.attention_norm.apply_to(x)?)?;
        let mixed = self.attention.attend_on_device(&qkv, &self.padding_qkv, windows)?;
        let places = Tensor::from_slice(&windows.places, windows.places.len(), x.device())?;
        let x = (self.mixed.apply_to(&mixed.index_select(&places, 0)?)? + x)?;
        let wide = self.wide.apply_and_activate(&self.feed_forward_norm.apply_to(&x)?, Activation::Gelu)?;
        self.narrow.apply_to(&wide)? + x
    }

    /// The output for x [positions, channels] on the processor. A tile of positions at a time goes through the layers,
    /// so that the numbers between two layers stay in the cache.
    fn apply_on_cpu(&self, x: &Tensor, windows: &MapWindows) -> Result<Tensor> {
        let (count, width) = x.dims2()?;
        let mut qkv = vec![0.0; count * 3 * width];
        with_f32_slice(x, |x| {
            each_tile(&mut qkv, 3 * width, |from, qkv, memory| {
                let rows = qkv.len() / (3 * width);
                let [normed] = split_memory(memory, [rows * width]);
                self.attention_norm.write_rows(&x[from * width..(from + rows) * width], normed)?;
                self.qkv.write_rows(normed, qkv)
            })
        })?;
        let qkv = Tensor::from_vec(qkv, (count, 3 * width), x.device())?;
        let mixed = self.attention.attend_on_cpu(&qkv, &self.padding_qkv, windows)?;
        drop(qkv);
        let mut y = vec![0.0; count * width];
        with_f32_slice(x, |x| with_f32_slice(&mixed, |mixed| self.feed_forward(x, mixed, windows, &mut y)))?;
        Tensor::from_vec(y, (count, width), x.device())
    }

    /// The layers after attention. `mixed` is in the order of the windows, and is put back into the order of the map.
    fn feed_forward(&self, x: &[f32], mixed: &[f32], windows: &MapWindows, y: &mut [f32]) -> Result<()> {
        let width = x.len() / windows.places.len().max(1);
        each_tile(y, width, |from, y, memory| {
            let count = y.len();
            let [states, normed, wide] = split_memory(memory, [count, count, TILE_ROWS * self.inner]);
            let wide = &mut wide[..count / width * self.inner];
            for (normed, &place) in normed.chunks_exact_mut(width).zip(&windows.places[from..]) {
                normed.copy_from_slice(&mixed[place as usize * width..(place as usize + 1) * width]);
            }
            self.mixed.write_rows(normed, states)?;
            states.iter_mut().zip(&x[from * width..]).for_each(|(state, x)| *state += x);
            self.feed_forward_norm.write_rows(states, normed)?;
            self.wide.write_rows(normed, wide)?;
            Activation::Gelu.map_on_this_thread(wide);
            self.narrow.write_rows(wide, y)?;
            y.iter_mut().zip(&*states).for_each(|(y, state)| *y += state);
            Ok(())
        })
    }
}

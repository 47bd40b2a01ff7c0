//! Attention within windows: each place sees only the places of its own window.

use super::windows::{MapWindows, bias_rows};
use crate::{
    LocalError,
    ops::{
        MultiHeadAttention,
        kernels::{ProductOptions, with_f32_slice, write_product},
    },
    weights::WeightScope,
};
use candle_core::{Result, Tensor};
use rayon::prelude::*;
use rten_gemm::{GemmInputA, GemmInputB};
use rten_simd::SimdOp;
use rten_tensor::NdTensorView;
use rten_vecmath::Softmax;

/// Added to the score of two places that do not see each other, so that its share becomes almost 0.
const HIDDEN_SCORE: f32 = -100.0;

/// Attention within windows, with a learned bias for the distance between two places.
pub(super) struct WindowAttention {
    heads: usize,
    /// The bias of each pair of places, [heads, places, places].
    bias: Tensor,
}

impl WindowAttention {
    /// Reads the biases from the tensor `table`. `edge` is that of a window.
    pub(super) fn from_weights(
        weights: &WeightScope<'_>,
        table: &str,
        heads: usize,
        edge: usize,
    ) -> std::result::Result<Self, LocalError> {
        let rows = (2 * edge - 1) * (2 * edge - 1);
        let biases = weights.read_state(table, &[rows, heads])?;
        let spread = || {
            let rows = bias_rows(edge).into_iter().map(|row| row as u32).collect::<Vec<_>>();
            let rows = Tensor::from_vec(rows, edge * edge * edge * edge, biases.device())?;
            biases.index_select(&rows, 0)?.t()?.contiguous()?.reshape((heads, edge * edge, edge * edge))
        };
        Ok(Self { heads, bias: spread().map_err(|error| weights.tensor_error(table, &error))? })
    }

    /// The states [places, channels] after attention, in the order of the windows. `qkv` has queries, keys and values
    /// [positions, 3 * channels] of a map, and `of_padding` those of padding [3 * channels].
    pub(super) fn attend_on_cpu(&self, qkv: &Tensor, of_padding: &Tensor, windows: &MapWindows) -> Result<Tensor> {
        let width = qkv.dim(1)? / 3;
        let mut mixed = vec![0.0; windows.positions.len() * width];
        with_f32_slice(qkv, |qkv| {
            with_f32_slice(of_padding, |of_padding| {
                with_f32_slice(&self.bias, |bias| {
                    let attend = WindowPass { qkv, padding_qkv: of_padding, bias, windows, width, heads: self.heads };
                    let each = mixed.par_chunks_mut(windows.size * width).enumerate();
                    each.try_for_each_init(Vec::new, |room, (window, mixed)| attend.attend_window(window, mixed, room))
                })
            })
        })?;
        Tensor::from_vec(mixed, (windows.positions.len(), width), qkv.device())
    }

    /// Like [`WindowAttention::attend_on_cpu`], with candle's operators.
    pub(super) fn attend_on_device(&self, qkv: &Tensor, of_padding: &Tensor, windows: &MapWindows) -> Result<Tensor> {
        let width = qkv.dim(1)? / 3;
        let (count, size, device) = (windows.window_count(), windows.size, qkv.device());
        let padding = qkv.dim(0)? as u32;
        let rows = windows.positions.iter().map(|&at| at.min(padding)).collect();
        let rows = Tensor::from_vec(rows, count * size, device)?;
        let all = Tensor::cat(&[qkv, &of_padding.unsqueeze(0)?.to_dtype(qkv.dtype())?], 0)?;
        let all = all.index_select(&rows, 0)?.reshape((count, size, 3 * width))?;
        let part = |at: usize| all.narrow(2, at * width, width);
        let mut hidden_scores = vec![0.0_f32; count * size * size];
        for (window, hidden_scores) in hidden_scores.chunks_mut(size * size).enumerate() {
            let Some(regions) = windows.window_regions(window) else { continue };
            for (pair, hidden_scores) in hidden_scores.iter_mut().enumerate() {
                *hidden_scores = if regions[pair / size] == regions[pair % size] { 0.0 } else { HIDDEN_SCORE };
            }
        }
        let hidden_scores =
            Tensor::from_vec(hidden_scores, (count, 1, size, size), device)?.to_dtype(self.bias.dtype())?;
        let bias = hidden_scores.broadcast_add(&self.bias.unsqueeze(0)?)?;
        let scale = 1.0 / ((width / self.heads) as f32).sqrt();
        let attention = MultiHeadAttention { heads: self.heads, scale, bias: Some(&bias) };
        attention.attend_to(&part(0)?, &part(1)?, &part(2)?)?.reshape((count * size, width))
    }
}

/// The inputs of one pass over all windows.
struct WindowPass<'a> {
    /// Queries, keys and values of the positions, and those of padding.
    qkv: &'a [f32],
    padding_qkv: &'a [f32],
    bias: &'a [f32],
    windows: &'a MapWindows,
    width: usize,
    heads: usize,
}

impl WindowPass<'_> {
    /// Writes the states [places, channels] of one window into `mixed`. `room` is memory to work in.
    fn attend_window(&self, window: usize, mixed: &mut [f32], room: &mut Vec<f32>) -> Result<()> {
        let (size, width, row) = (self.windows.size, self.width, 3 * self.width);
        let head_width = width / self.heads;
        room.resize(size * row + size * size + size * head_width, 0.0);
        let (window_qkv, rest) = room.split_at_mut(size * row);
        let (scores, head_states) = rest.split_at_mut(size * size);
        let positions = &self.windows.positions[window * size..(window + 1) * size];
        for (window_qkv, &position) in window_qkv.chunks_exact_mut(row).zip(positions) {
            let from = position as usize * row;
            window_qkv.copy_from_slice(if position == MapWindows::PADDING_POSITION {
                self.padding_qkv
            } else {
                &self.qkv[from..from + row]
            });
        }
        let regions = self.windows.window_regions(window);
        let scale = 1.0 / (head_width as f32).sqrt();
        for head in 0..self.heads {
            let part = |at: usize| {
                let from = at * width + head * head_width;
                let to = from + (size - 1) * row + head_width;
                NdTensorView::from_data_with_strides([size, head_width], &window_qkv[from..to], [row, 1])
                    .map_err(candle_core::Error::wrap)
            };
            let options = ProductOptions { alpha: scale, ..ProductOptions::default() };
            let keys = GemmInputB::Unpacked(part(1)?.transposed());
            write_product(scores, GemmInputA::Unpacked(part(0)?), keys, options)?;
            self.normalise_scores(scores, head, regions);
            let weights = GemmInputA::Unpacked(NdTensorView::from_data([size, size], &*scores));
            write_product(head_states, weights, GemmInputB::Unpacked(part(2)?), ProductOptions::default())?;
            for (mixed, head_states) in mixed.chunks_exact_mut(width).zip(head_states.chunks_exact(head_width)) {
                mixed[head * head_width..(head + 1) * head_width].copy_from_slice(head_states);
            }
        }
        Ok(())
    }

    /// Adds the biases of a head to the scores of a window, hides places that are no neighbours on the map, and makes
    /// each row sum to 1.
    fn normalise_scores(&self, scores: &mut [f32], head: usize, regions: Option<&[u8]>) {
        let size = self.windows.size;
        let bias = &self.bias[head * size * size..(head + 1) * size * size];
        for (at, (scores, bias)) in scores.chunks_exact_mut(size).zip(bias.chunks_exact(size)).enumerate() {
            scores.iter_mut().zip(bias).for_each(|(score, bias)| *score += bias);
            if let Some(regions) = regions {
                for (score, region) in scores.iter_mut().zip(regions) {
                    *score += if *region == regions[at] { 0.0 } else { HIDDEN_SCORE };
                }
            }
            Softmax::new_mut(scores).dispatch();
        }
    }
}

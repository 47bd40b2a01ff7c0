//! Merges patches between two stages: each square of four positions becomes one position with twice the channels.

use crate::{
    LocalError,
    ops::{LayerNorm, LinearLayer},
    weights::WeightScope,
};
use candle_core::{Result, Tensor};

/// Merges squares of four positions: a norm of their joined channels, and a layer that halves these.
pub(super) struct PatchMerging {
    norm: LayerNorm,
    reduction: LinearLayer,
}

impl PatchMerging {
    pub(super) fn from_weights(
        weights: &WeightScope<'_>,
        width: usize,
        epsilon: f64,
    ) -> std::result::Result<Self, LocalError> {
        Ok(Self {
            norm: weights.read_layer_norm("norm", 4 * width, epsilon)?,
            reduction: weights.read_linear("reduction", 4 * width, 2 * width)?,
        })
    }

    /// Halves height and width (rounded up) of x [batch, height, width, channels], and doubles the channels. The
    /// channels of a square are joined in the order upper left, lower left, upper right, lower right.
    pub(super) fn merge_squares(&self, x: &Tensor) -> Result<Tensor> {
        let (batch, height, width, channels) = x.dims4()?;
        let (down, across) = (height.div_ceil(2), width.div_ceil(2));
        let x = x.pad_with_zeros(1, 0, 2 * down - height)?.pad_with_zeros(2, 0, 2 * across - width)?;
        let squares = x.reshape((batch, down, 2, across, 2, channels))?.permute((0, 1, 3, 4, 2, 5))?;
        let squares = squares.contiguous()?.reshape((batch, down, across, 4 * channels))?;
        self.reduction.apply_to(&self.norm.apply_to(&squares)?)
    }
}

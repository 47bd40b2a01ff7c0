//! A convolution whose stride is its size is a product with a matrix.

use candle_core::{Result, Tensor};

/// Cuts pictures [batch, 3, height, width] into squares of `size` pixels: [batch, patches, 3 * size * size], rows from the top.
/// What a kernel [outputs, 3, size, size] does to them is a layer of weight [outputs, 3 * size * size].
pub(crate) fn patches(pictures: &Tensor, size: usize) -> Result<Tensor> {
    let (batch, channels, height, width) = pictures.dims4()?;
    let (down, across) = (height / size, width / size);
    pictures.reshape((batch, channels, down, size, across, size))?.permute((0, 2, 4, 1, 3, 5))?.reshape((
        batch,
        down * across,
        channels * size * size,
    ))
}

//! The first steps of a model: looking up the vectors of token ids, and cutting a picture into patches.

use candle_core::{DType, Result, Tensor};

/// A table [count, size] with a vector for each id.
pub(crate) struct EmbeddingTable {
    table: Tensor,
}

impl EmbeddingTable {
    pub(crate) fn new(table: Tensor) -> Self {
        Self { table }
    }

    /// The rows [.., size] of ids [..]. On the CPU they have 32 bits, whatever the precision of the table.
    pub(crate) fn look_up(&self, ids: &Tensor) -> Result<Tensor> {
        let mut shape = ids.dims().to_vec();
        shape.push(self.table.dim(1)?);
        let rows = self.table.index_select(&ids.flatten_all()?, 0)?.reshape(shape)?;
        if rows.device().is_cpu() { rows.to_dtype(DType::F32) } else { Ok(rows) }
    }

    /// The whole table, for a layer that shares it.
    pub(crate) fn whole_table(&self) -> &Tensor {
        &self.table
    }
}

/// Cuts pictures [batch, 3, height, width] into squares of `size` pixels, [batch, patches, 3 * size * size], rows from
/// the top. A convolution with a stride equal to its size is a product of these patches with a matrix: a kernel
/// [outputs, 3, size, size] becomes a layer with the weight [outputs, 3 * size * size].
pub(crate) fn cut_patches(pictures: &Tensor, size: usize) -> Result<Tensor> {
    let (batch, channels, height, width) = pictures.dims4()?;
    let (down, across) = (height / size, width / size);
    pictures.reshape((batch, channels, down, size, across, size))?.permute((0, 2, 4, 1, 3, 5))?.reshape((
        batch,
        down * across,
        channels * size * size,
    ))
}

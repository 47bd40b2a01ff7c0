//! Tables that are looked up by ids.

use candle_core::{DType, Result, Tensor};

/// A table [count, size].
pub(crate) struct Embedding {
    table: Tensor,
}

impl Embedding {
    pub(crate) fn new(table: Tensor) -> Self {
        Self { table }
    }

    /// Rows of ids [..]: [.., size]. On the processor they have 32 bits, whatever the table has.
    pub(crate) fn of(&self, ids: &Tensor) -> Result<Tensor> {
        let mut shape = ids.dims().to_vec();
        shape.push(self.table.dim(1)?);
        let rows = self.table.index_select(&ids.flatten_all()?, 0)?.reshape(shape)?;
        if rows.device().is_cpu() { rows.to_dtype(DType::F32) } else { Ok(rows) }
    }

    /// The whole table, for a layer that shares it.
    pub(crate) fn table(&self) -> &Tensor {
        &self.table
    }
}

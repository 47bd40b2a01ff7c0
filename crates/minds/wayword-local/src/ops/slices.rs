//! From candle's tensors to slices of numbers and back.

use candle_core::{CpuStorage, Layout, Result, Tensor, WithDType, bail};

/// Pieces of work are at least so long, numbers: below it another thread costs more than it brings.
pub(super) const PIECE: usize = 16 << 10;

/// The numbers of a tensor that lies in one piece.
pub(super) fn slice<'a, T: WithDType>(storage: &'a CpuStorage, layout: &Layout) -> Result<&'a [T]> {
    let Some((from, to)) = layout.contiguous_offsets() else { bail!("a tensor lies in pieces") };
    let all = storage.as_slice::<T>()?;
    match all.get(from..to) {
        Some(slice) => Ok(slice),
        None => bail!("a tensor ends before its shape does"),
    }
}

/// The last axis of a tensor, and how many there are of it.
pub(super) fn rows(layout: &Layout) -> Result<(usize, usize)> {
    let dims = layout.shape().dims();
    let Some((&last, others)) = dims.split_last() else { bail!("a number has no rows") };
    Ok((others.iter().product(), last))
}

/// Whether our own operators do it.
pub(super) fn is_ours(tensor: &Tensor) -> bool {
    tensor.device().is_cpu() && tensor.dtype() == candle_core::DType::F32
}

/// How many rows of a length make a piece of work.
pub(super) fn rows_per_piece(row: usize) -> usize {
    (PIECE / row.max(1)).max(1)
}

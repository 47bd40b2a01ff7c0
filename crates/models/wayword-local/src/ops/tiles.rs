//! Computes the rows of a tensor in tiles. A tile goes through several layers while it is in the processor's cache.

use candle_core::Result;
use rayon::prelude::*;

/// The most rows of a tile: as many as the kernels take at a time.
pub(crate) const TILE_ROWS: usize = 64;

/// Calls `tile` for each tile of y, a tensor with rows of `width` numbers, on all threads. `tile` gets the number of
/// the first row, the rows, and memory to work in, which contains leftovers of other tiles.
pub(crate) fn each_tile(
    y: &mut [f32],
    width: usize,
    tile: impl Fn(usize, &mut [f32], &mut Vec<f32>) -> Result<()> + Sync,
) -> Result<()> {
    // If there are few rows, smaller tiles give every thread some.
    let rows = y.len() / width.max(1);
    let rows_per_thread = rows.div_ceil(rayon::current_num_threads()).next_multiple_of(8);
    let tiles = y.par_chunks_mut(width.max(1) * rows_per_thread.min(TILE_ROWS)).enumerate();
    tiles.try_for_each_init(Vec::new, |memory, (at, y)| tile(at * rows_per_thread.min(TILE_ROWS), y, memory))
}

/// Splits memory into parts of these lengths. The memory grows if necessary.
pub(crate) fn split_memory<const N: usize>(memory: &mut Vec<f32>, lengths: [usize; N]) -> [&mut [f32]; N] {
    let needed = lengths.iter().sum();
    if memory.len() < needed {
        memory.resize(needed, 0.0);
    }
    let mut rest = &mut memory[..];
    lengths.map(|length| {
        let (part, after) = std::mem::take(&mut rest).split_at_mut(length);
        rest = after;
        part
    })
}

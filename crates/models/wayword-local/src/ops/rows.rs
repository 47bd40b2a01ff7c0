//! Distributes the rows of a computation over the threads.
//!
//! A thread takes some rows at a time through all steps of a layer. So the numbers between two steps stay in the cache,
//! and are never allocated for all rows.

use candle_core::Result;
use rayon::prelude::*;
use std::cell::RefCell;

/// The fewest and the most rows that a thread takes at a time. If there are fewer, the kernels distribute the columns
/// of a product instead.
const MIN_ROWS_PER_THREAD: usize = 48;
const MAX_ROWS_PER_THREAD: usize = 144;

/// The number of rows that the kernels compute together.
const KERNEL_TILE_ROWS: usize = 6;

thread_local! {
    /// Memory from earlier computations of this thread, to be used again.
    static SPARE: RefCell<Vec<Vec<f32>>> = const { RefCell::new(Vec::new()) };
}

/// Calls `each` with some rows of x, of length `inputs`, and the same rows of y, of length `outputs`, on all threads.
pub(super) fn for_row_pieces(
    (x, inputs): (&[f32], usize),
    (y, outputs): (&mut [f32], usize),
    each: impl Fn(&[f32], &mut [f32]) -> Result<()> + Sync,
) -> Result<()> {
    if inputs == 0 || outputs == 0 {
        return each(x, y);
    }
    match rows_per_thread(x.len() / inputs, rayon::current_num_threads()) {
        None => each(x, y),
        Some(rows) => {
            let parts = y.par_chunks_mut(rows * outputs).zip(x.par_chunks(rows * inputs));
            parts.with_max_len(1).try_for_each(|(y, x)| each(x, y))
        }
    }
}

/// The number of rows, of `count`, that a thread takes at a time, so that all threads end at about the same time.
/// `None` if there are too few rows to distribute.
fn rows_per_thread(count: usize, threads: usize) -> Option<usize> {
    if threads < 2 || count < threads * MIN_ROWS_PER_THREAD {
        return (threads < 2 && count > MAX_ROWS_PER_THREAD).then_some(MAX_ROWS_PER_THREAD);
    }
    let longest = |rows: &usize| count.div_ceil(*rows).div_ceil(threads) * rows;
    (MIN_ROWS_PER_THREAD / KERNEL_TILE_ROWS..=MAX_ROWS_PER_THREAD / KERNEL_TILE_ROWS)
        .rev()
        .map(|tiles| tiles * KERNEL_TILE_ROWS)
        .min_by_key(longest)
}

/// Calls `then` with memory for `length` numbers. Their values are leftovers of earlier uses.
pub(super) fn with_spare_memory<T>(length: usize, then: impl FnOnce(&mut [f32]) -> T) -> T {
    let mut spare = SPARE.with(|spare| spare.borrow_mut().pop()).unwrap_or_default();
    if spare.len() < length {
        spare.resize(length, 0.0);
    }
    let result = then(&mut spare[..length]);
    SPARE.with(|kept| kept.borrow_mut().push(spare));
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_threads_end_at_about_the_same_time() {
        assert_eq!([rows_per_thread(95, 2), rows_per_thread(700, 16), rows_per_thread(144, 1)], [None; 3]);
        for (count, threads) in [(96, 2), (400, 2), (3601, 2), (3601, 16), (830, 2), (3601, 1)] {
            let rows = rows_per_thread(count, threads).unwrap();
            let longest = count.div_ceil(rows).div_ceil(threads) * rows;
            assert!(
                longest * threads < count + count / 12 + KERNEL_TILE_ROWS * threads,
                "{count} on {threads}: {rows}"
            );
        }
    }

    #[test]
    fn every_row_is_computed_once() {
        for count in [0, 1, 7, 150, 1000] {
            let x: Vec<f32> = (0..count * 2).map(|at| at as f32).collect();
            let mut y = vec![0.0; count];
            let sum = |x: &[f32], y: &mut [f32]| {
                y.iter_mut().zip(x.chunks(2)).for_each(|(y, x)| *y += x[0] + x[1]);
                Ok(())
            };
            for_row_pieces((&x, 2), (&mut y, 1), sum).unwrap();
            assert!(y.iter().enumerate().all(|(at, &y)| y == (4 * at + 1) as f32));
        }
    }

    #[test]
    fn spare_memory_may_be_asked_for_within_itself() {
        let sum = with_spare_memory(3, |outer| {
            outer.fill(1.0);
            with_spare_memory(5, |inner| inner.fill(2.0));
            outer.iter().sum::<f32>()
        });
        assert_eq!(sum, 3.0);
    }
}

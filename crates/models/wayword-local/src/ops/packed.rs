//! Weights in 32 bits on the CPU, packed once into the order in which the kernels read them.

use super::{
    kernels::{ProductOptions, pack_weight, write_product},
    rows::with_spare_memory,
};
use candle_core::{Result, bail};
use rten_gemm::{BiasVector, GemmInputA, GemmInputB, PackedBMatrix};
use rten_tensor::NdTensorView;

/// The most columns that the kernels of `rten-gemm` give to a thread at a time.
const MAX_COLUMNS_PER_THREAD: usize = 1024;

/// The number of columns that the kernels compute together.
const KERNEL_TILE_COLUMNS: usize = 32;

/// A matrix [outputs, inputs], in pieces of columns (outputs).
///
/// The kernels give blocks of 1024 columns to the threads. With 3072 columns on 2 threads there are three blocks, so
/// that one thread works on the last block while the other one waits. Two pieces of 1536 columns keep both threads
/// busy.
pub(super) struct PackedMatrix {
    /// The pieces, each with the number of its columns.
    pieces: Vec<(PackedBMatrix<f32>, usize)>,
    inputs: usize,
    outputs: usize,
}

impl PackedMatrix {
    pub(super) fn new(weight: &[f32], outputs: usize, inputs: usize) -> Self {
        let columns = columns_per_piece(outputs, rayon::current_num_threads());
        let pieces = weight.chunks((columns * inputs).max(1));
        let piece = |weight: &[f32]| {
            let columns = weight.len() / inputs.max(1);
            (pack_weight(weight, columns, inputs), columns)
        };
        Self { pieces: pieces.map(piece).collect(), inputs, outputs }
    }

    /// Multiplies x [count, inputs] by the matrix, adds a bias, and writes the result into y [count, outputs], or adds
    /// it to y if `adds`.
    pub(super) fn multiply_rows(&self, x: &[f32], bias: Option<&[f32]>, y: &mut [f32], adds: bool) -> Result<()> {
        let count = x.len() / self.inputs.max(1);
        if x.len() != count * self.inputs || y.len() != count * self.outputs {
            bail!("{} and {} numbers are not rows of {} and {}", x.len(), y.len(), self.inputs, self.outputs);
        }
        let x = || GemmInputA::Unpacked(NdTensorView::from_data([count, self.inputs], x));
        let part = |matrix, from: usize, columns: usize, y: &mut [f32], adds: bool| {
            let bias = bias.map(|bias| BiasVector::Row(&bias[from..from + columns]));
            let options = ProductOptions { bias, beta: if adds { 1.0 } else { 0.0 }, ..ProductOptions::default() };
            write_product(y, x(), GemmInputB::Packed(matrix), options)
        };
        if let [(matrix, columns)] = &self.pieces[..] {
            return part(matrix, 0, *columns, y, adds);
        }
        let mut from = 0;
        for (matrix, columns) in &self.pieces {
            with_spare_memory(count * columns, |piece| {
                part(matrix, from, *columns, piece, false)?;
                for (y, piece) in y.chunks_mut(self.outputs).zip(piece.chunks(*columns)) {
                    let y = &mut y[from..from + columns];
                    match adds {
                        true => y.iter_mut().zip(piece).for_each(|(y, piece)| *y += piece),
                        false => y.copy_from_slice(piece),
                    }
                }
                Ok::<_, candle_core::Error>(())
            })?;
            from += columns;
        }
        Ok(())
    }
}

/// The number of columns of a piece, so that all threads have work until the end.
fn columns_per_piece(outputs: usize, threads: usize) -> usize {
    let pieces = outputs.div_ceil(threads * MAX_COLUMNS_PER_THREAD);
    if threads < 2 || pieces < 2 {
        outputs
    } else {
        outputs.div_ceil(pieces).next_multiple_of(threads * KERNEL_TILE_COLUMNS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_come_out_even() {
        for (outputs, threads, columns) in [
            (3072, 2, 1536),
            (2304, 2, 1152),
            (768, 2, 768),
            (3072, 1, 3072),
            (3072, 4, 3072),
            (5, 2, 5),
            (2049, 2, 1088),
        ] {
            assert_eq!(columns_per_piece(outputs, threads), columns, "{outputs} on {threads}");
        }
    }

    #[test]
    fn product_of_the_pieces_equals_that_of_the_whole_matrix() {
        // Small whole numbers, so that all products are exact.
        let (outputs, inputs) = (5000, 3);
        let weight: Vec<f32> = (0..outputs * inputs).map(|at| (at % 11) as f32).collect();
        let bias: Vec<f32> = (0..outputs).map(|at| (at % 7) as f32).collect();
        let matrix = PackedMatrix::new(&weight, outputs, inputs);
        let x = [1.0, 2.0, 3.0, 0.5, 0.0, 1.0];
        let dot = |x: &[f32], w: &[f32]| w.iter().zip(x).map(|(w, x)| w * x).sum::<f32>();
        let row = |x: &[f32]| weight.chunks(inputs).zip(&bias).map(|(w, b)| dot(x, w) + b).collect::<Vec<_>>();
        let expected: Vec<f32> = x.chunks(inputs).flat_map(row).collect();
        let mut y = vec![0.0; 2 * outputs];
        matrix.multiply_rows(&x, Some(&bias), &mut y, false).unwrap();
        assert_eq!(y, expected);
        matrix.multiply_rows(&x, Some(&bias), &mut y, true).unwrap();
        assert!(y.iter().zip(&expected).all(|(y, expected)| *y == 2.0 * expected));
        assert!(matrix.multiply_rows(&x[1..], None, &mut y, false).is_err());
    }
}

//! Weights in 16 bits on the CPU. They take half the memory, and a product reads half as many bytes. The kernels
//! compute in 32 bits, so a piece of the weights at a time is widened.

use super::kernels::{ProductOptions, write_product};
use candle_core::{DType, Result, Tensor, bail};
use half::{bf16, f16, slice::HalfFloatSliceExt};
use rayon::prelude::*;
use rten_gemm::{BiasVector, GemmInputA, GemmInputB};
use rten_tensor::NdTensorView;

/// The number of outputs that are widened to 32 bits at a time: few enough for the CPU's cache.
const OUTPUTS_PER_PIECE: usize = 128;

/// A matrix [outputs, inputs] in 16 bits.
pub(super) struct HalfMatrix {
    numbers: HalfNumbers,
}

/// The numbers of a matrix, row by row.
enum HalfNumbers {
    Bf16(Vec<bf16>),
    F16(Vec<f16>),
}

impl HalfMatrix {
    pub(super) fn new(weight: &Tensor) -> Result<Self> {
        let flat = weight.flatten_all()?;
        let numbers = match weight.dtype() {
            DType::BF16 => HalfNumbers::Bf16(flat.to_vec1()?),
            DType::F16 => HalfNumbers::F16(flat.to_vec1()?),
            other => bail!("weights of type {other:?} are not supported"),
        };
        Ok(Self { numbers })
    }

    /// Writes x [count, inputs] times the matrix, plus a bias, into y [count, outputs].
    pub(super) fn multiply_rows(&self, x: &[f32], inputs: usize, bias: Option<&[f32]>, y: &mut [f32]) -> Result<()> {
        let outputs = self.len() / inputs.max(1);
        let count = x.len() / inputs.max(1);
        let x = NdTensorView::from_data([count, inputs], x);
        let piece = |from: usize| -> Result<Vec<f32>> {
            let to = (from + OUTPUTS_PER_PIECE).min(outputs);
            let mut weights = vec![0.0; (to - from) * inputs];
            self.widen_into(from * inputs, &mut weights);
            let weights = NdTensorView::from_data([to - from, inputs], &weights[..]);
            let mut y = vec![0.0; count * (to - from)];
            let options =
                ProductOptions { bias: bias.map(|bias| BiasVector::Row(&bias[from..to])), ..ProductOptions::default() };
            let weights = GemmInputB::Unpacked(weights.transposed());
            write_product(&mut y, GemmInputA::Unpacked(x), weights, options)?;
            Ok(y)
        };
        let starts: Vec<usize> = (0..outputs).step_by(OUTPUTS_PER_PIECE).collect();
        let pieces: Vec<Vec<f32>> = starts.into_par_iter().map(piece).collect::<Result<_>>()?;
        for (row, y) in y.chunks_mut(outputs.max(1)).enumerate() {
            for (piece, y) in pieces.iter().zip(y.chunks_mut(OUTPUTS_PER_PIECE)) {
                let width = y.len();
                y.copy_from_slice(&piece[row * width..(row + 1) * width]);
            }
        }
        Ok(())
    }

    fn len(&self) -> usize {
        match &self.numbers {
            HalfNumbers::Bf16(numbers) => numbers.len(),
            HalfNumbers::F16(numbers) => numbers.len(),
        }
    }

    /// Writes the numbers from index `from` on as 32 bits.
    fn widen_into(&self, from: usize, into: &mut [f32]) {
        match &self.numbers {
            HalfNumbers::Bf16(numbers) => numbers[from..from + into.len()].convert_to_f32_slice(into),
            HalfNumbers::F16(numbers) => numbers[from..from + into.len()].convert_to_f32_slice(into),
        }
    }
}

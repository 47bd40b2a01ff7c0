//! Layer norms and root-mean-square norms over the last axis.

use super::kernels::{contiguous_slice, is_cpu_f32, row_shape, rows_per_piece, with_f32_slice};
use candle_core::{CpuStorage, CustomOp2, CustomOp3, Layout, Result, Shape, Tensor};
use rayon::prelude::*;
use rten_simd::SimdOp;
use rten_vecmath::{Normalize, NormalizeOptions, Sum, SumSquare, SumSquareSub};

/// Scales to mean 0 and variance 1, then applies a weight and a bias.
pub(crate) struct LayerNorm {
    weight: Tensor,
    bias: Tensor,
    epsilon: f64,
}

/// Scales to root mean square 1, then applies a weight.
pub(crate) struct RmsNorm {
    weight: Tensor,
    epsilon: f64,
}

impl LayerNorm {
    pub(crate) fn new(weight: Tensor, bias: Tensor, epsilon: f64) -> Self {
        Self { weight: to_processor_precision(weight), bias: to_processor_precision(bias), epsilon }
    }

    /// The norm of x [.., size].
    pub(crate) fn apply_to(&self, x: &Tensor) -> Result<Tensor> {
        if is_cpu_f32(x) {
            return x.contiguous()?.apply_op3_no_bwd(&self.weight, &self.bias, &RowStandardiser(self.epsilon));
        }
        candle_nn::ops::layer_norm(&x.contiguous()?, &self.weight, &self.bias, self.epsilon as f32)
    }

    /// Writes the norm of the rows of x into y, on the CPU.
    pub(crate) fn write_rows(&self, x: &[f32], y: &mut [f32]) -> Result<()> {
        y.copy_from_slice(x);
        self.replace_rows(y)
    }

    /// Replaces the rows of y by their norms, on the CPU.
    pub(super) fn replace_rows(&self, y: &mut [f32]) -> Result<()> {
        with_f32_slice(&self.weight, |weight| {
            with_f32_slice(&self.bias, |bias| {
                let standard = RowStandardiser(self.epsilon);
                y.chunks_exact_mut(weight.len().max(1)).for_each(|row| standard.standardise_row(row, weight, bias));
                Ok(())
            })
        })
    }
}

impl RmsNorm {
    pub(crate) fn new(weight: Tensor, epsilon: f64) -> Self {
        Self { weight: to_processor_precision(weight), epsilon }
    }

    /// The norm of x [.., size].
    pub(crate) fn apply_to(&self, x: &Tensor) -> Result<Tensor> {
        if is_cpu_f32(x) {
            return x.contiguous()?.apply_op2_no_bwd(&self.weight, &RootMeanSquare(self.epsilon));
        }
        candle_nn::ops::rms_norm(&x.contiguous()?, &self.weight, self.epsilon as f32)
    }
}

/// Widens a weight on the CPU: the states between layers have 32 bits there, whatever the precision of the weights.
fn to_processor_precision(weight: Tensor) -> Tensor {
    if weight.device().is_cpu() { weight.to_dtype(candle_core::DType::F32).unwrap_or(weight) } else { weight }
}

/// [`LayerNorm`] on the CPU, as an operator of candle. It holds the epsilon, which is added to variances.
struct RowStandardiser(f64);

impl RowStandardiser {
    fn standardise_row(&self, row: &mut [f32], weight: &[f32], bias: &[f32]) {
        let size = row.len() as f32;
        let mean = Sum::new(row).dispatch() / size;
        let variance = SumSquareSub::new(row, mean).dispatch() / size;
        let options = NormalizeOptions {
            pre_scale_bias: mean,
            scale: 1.0 / (variance + self.0 as f32).sqrt(),
            element_scale: Some(weight),
            element_bias: Some(bias),
            ..NormalizeOptions::default()
        };
        Normalize::new_mut(row, options).dispatch();
    }
}

impl CustomOp3 for RowStandardiser {
    fn name(&self) -> &'static str {
        "layer-norm"
    }

    fn cpu_fwd(
        &self,
        x: &CpuStorage,
        x_layout: &Layout,
        weight: &CpuStorage,
        weight_layout: &Layout,
        bias: &CpuStorage,
        bias_layout: &Layout,
    ) -> Result<(CpuStorage, Shape)> {
        let (weight, bias) =
            (contiguous_slice::<f32>(weight, weight_layout)?, contiguous_slice::<f32>(bias, bias_layout)?);
        let row = |row: &mut [f32]| self.standardise_row(row, weight, bias);
        Ok((each_row(x, x_layout, row)?, x_layout.shape().clone()))
    }
}

/// [`RmsNorm`] on the CPU, as an operator of candle. It holds the epsilon, which is added to mean squares.
struct RootMeanSquare(f64);

impl CustomOp2 for RootMeanSquare {
    fn name(&self) -> &'static str {
        "rms-norm"
    }

    fn cpu_fwd(
        &self,
        x: &CpuStorage,
        x_layout: &Layout,
        weight: &CpuStorage,
        weight_layout: &Layout,
    ) -> Result<(CpuStorage, Shape)> {
        let (_, size) = row_shape(x_layout)?;
        let weight = contiguous_slice::<f32>(weight, weight_layout)?;
        let row = |row: &mut [f32]| {
            let mean_square = SumSquare::new(row).dispatch() / size as f32;
            let scale = 1.0 / (mean_square + self.0 as f32).sqrt();
            let options = NormalizeOptions { scale, element_scale: Some(weight), ..NormalizeOptions::default() };
            Normalize::new_mut(row, options).dispatch();
        };
        Ok((each_row(x, x_layout, row)?, x_layout.shape().clone()))
    }
}

/// Applies a function to each row of a copy, on all threads.
fn each_row(x: &CpuStorage, layout: &Layout, row: impl Fn(&mut [f32]) + Sync) -> Result<CpuStorage> {
    let mut y = contiguous_slice::<f32>(x, layout)?.to_vec();
    let size = row_shape(layout)?.1.max(1);
    let piece = |piece: &mut [f32]| piece.chunks_mut(size).for_each(&row);
    y.par_chunks_mut(size * rows_per_piece(size)).for_each(piece);
    Ok(CpuStorage::F32(y))
}

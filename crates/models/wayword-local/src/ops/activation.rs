//! Activation functions. On the CPU this crate computes them in parallel. Tensors on other devices or of other types
//! are left to candle.

use super::kernels::{PIECE_NUMBERS, contiguous_slice, is_cpu_f32};
use candle_core::{CpuStorage, CustomOp1, Layout, Result, Shape, Tensor};
use rayon::prelude::*;
use rten_simd::SimdUnaryOp;
use rten_vecmath::{ApproxGelu, Gelu, Sigmoid, Silu, Swish};
use serde::Deserialize;

/// Activation functions, by their names in checkpoints' configurations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub(crate) enum Activation {
    /// GELU with the error function.
    #[serde(rename = "gelu")]
    Gelu,
    /// GELU with the hyperbolic tangent.
    #[serde(rename = "gelu_new", alias = "gelu_pytorch_tanh", alias = "gelu_fast")]
    GeluTanh,
    /// x * sigmoid(1.702 x), which CLIP uses.
    #[serde(rename = "quick_gelu")]
    QuickGelu,
    /// max(x, 0).
    #[serde(rename = "relu")]
    Relu,
    /// x * sigmoid(x).
    #[serde(rename = "silu", alias = "swish")]
    Silu,
    /// 1 / (1 + exp(-x)).
    #[serde(rename = "sigmoid")]
    Sigmoid,
}

impl Activation {
    /// Applies the function to each number of a tensor.
    pub(crate) fn apply_to(self, x: &Tensor) -> Result<Tensor> {
        // Tensors that this crate's kernels can compute go there; candle computes the others.
        if is_cpu_f32(x) {
            return x.contiguous()?.apply_op1_no_bwd(&self);
        }
        match self {
            Self::Gelu => x.gelu_erf(),
            Self::GeluTanh => x.gelu(),
            Self::QuickGelu => x * candle_nn::ops::sigmoid(&(x * 1.702)?)?,
            Self::Relu => x.relu(),
            Self::Silu => x.silu(),
            Self::Sigmoid => candle_nn::ops::sigmoid(x),
        }
    }

    /// Applies the function to each number, on all threads.
    pub(super) fn map_on_threads(self, numbers: &mut [f32]) {
        numbers.par_chunks_mut(PIECE_NUMBERS).for_each(|piece| self.map_on_this_thread(piece));
    }

    /// Applies the function to each number, on this thread.
    pub(crate) fn map_on_this_thread(self, numbers: &mut [f32]) {
        match self {
            Self::Gelu => Gelu {}.map_mut(numbers),
            Self::GeluTanh => ApproxGelu {}.map_mut(numbers),
            Self::QuickGelu => Swish { alpha: 1.702 }.map_mut(numbers),
            Self::Relu => numbers.iter_mut().for_each(|number| *number = number.max(0.0)),
            Self::Silu => Silu {}.map_mut(numbers),
            Self::Sigmoid => Sigmoid {}.map_mut(numbers),
        }
    }
}

impl CustomOp1 for Activation {
    fn name(&self) -> &'static str {
        "activation"
    }

    fn cpu_fwd(&self, storage: &CpuStorage, layout: &Layout) -> Result<(CpuStorage, Shape)> {
        let mut numbers = contiguous_slice::<f32>(storage, layout)?.to_vec();
        self.map_on_threads(&mut numbers);
        Ok((CpuStorage::F32(numbers), layout.shape().clone()))
    }
}

//! Products with quantised weights.

use super::file::GgufFile;
use crate::{LocalError, ops::Linear};
use candle_core::{
    Module, Result, Tensor,
    quantized::{QMatMul, QTensor},
};
use std::sync::Arc;

/// From so many tokens on, widening the weights costs less than it brings: the product then runs on the kernels for 32 bits.
const MANY: usize = 128;

/// A matrix as the file has it.
pub(super) struct Product(QMatMul);

impl Product {
    /// Reads a matrix [outputs, inputs].
    pub(super) fn load(
        file: &GgufFile,
        name: &str,
        shape: &[usize],
        device: &candle_core::Device,
    ) -> std::result::Result<Self, LocalError> {
        Self::of(file, name, Arc::new(file.tensor(name, shape, device)?))
    }

    /// A matrix that something else has read.
    pub(super) fn of(file: &GgufFile, name: &str, weight: Arc<QTensor>) -> std::result::Result<Self, LocalError> {
        QMatMul::from_arc(weight).map(Self).map_err(|error| file.wrong(format!("{name}: {error}")))
    }

    /// x [.., inputs] times it: [.., outputs].
    pub(super) fn times(&self, x: &Tensor) -> Result<Tensor> {
        let tokens = x.elem_count() / x.dim(candle_core::D::Minus1)?.max(1);
        match &self.0 {
            QMatMul::QTensor(weight) if x.device().is_cpu() && tokens >= MANY => {
                Linear::new(&weight.dequantize(x.device())?, None)?.of(x)
            }
            weight => weight.forward(x),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use candle_core::{Device, quantized::GgmlDType};

    #[test]
    fn many_tokens_are_multiplied_with_the_widened_weights() {
        let wave = |count: usize| (0..count).map(|at| (at as f32 * 0.37).sin()).collect::<Vec<_>>();
        let weight = Tensor::from_vec(wave(96 * 64), (96, 64), &Device::Cpu).unwrap();
        let quantised = QTensor::quantize(&weight, GgmlDType::Q8_0).unwrap();
        let wide = quantised.dequantize(&Device::Cpu).unwrap();
        let product = Product(QMatMul::from_qtensor(quantised).unwrap());
        for (tokens, tolerance) in [(MANY, 1e-5), (4, 0.1)] {
            let x = Tensor::from_vec(wave(tokens * 64), (1, tokens, 64), &Device::Cpu).unwrap();
            let exact = x.broadcast_matmul(&wide.t().unwrap()).unwrap();
            let off = (product.times(&x).unwrap() - exact).unwrap().abs().unwrap().max_all().unwrap();
            let off = off.to_scalar::<f32>().unwrap();
            assert!(off < tolerance, "{tokens} tokens: {off}");
        }
    }
}

//! Linear layers.

use super::{
    Activation,
    half::HalfMatrix,
    kernels::{Options, packed, product, rows, slice},
};
use candle_core::{CpuStorage, CustomOp1, DType, Layout, Result, Shape, Tensor, bail};
use rten_gemm::{BiasVector, GemmInputA, GemmInputB, PackedBMatrix};
use rten_tensor::NdTensorView;

/// x times a matrix, plus a bias: from [.., inputs] to [.., outputs].
pub(crate) struct Linear {
    matrix: Matrix,
    bias: Option<Tensor>,
    outputs: usize,
}

/// Weights in the form for the computation. The checkpoint's own tensor is not kept in addition.
enum Matrix {
    /// Packed once for the CPU kernels.
    Packed(PackedBMatrix<f32>),
    /// In 16 bits on the CPU: widened piece by piece for each product.
    Half(HalfMatrix),
    /// Transposed, for candle.
    Plain(Tensor),
}

impl Linear {
    /// A layer from a checkpoint's weight [outputs, inputs] and bias [outputs].
    pub(crate) fn new(weight: &Tensor, bias: Option<Tensor>) -> Result<Self> {
        let (outputs, inputs) = weight.dims2()?;
        let matrix = if !weight.device().is_cpu() {
            Matrix::Plain(weight.t()?)
        } else if weight.dtype() == DType::F32 {
            let weight = weight.contiguous()?;
            let (storage, layout) = weight.storage_and_layout();
            let candle_core::Storage::Cpu(storage) = &*storage else { bail!("a weight is not on its device") };
            Matrix::Packed(packed(slice::<f32>(storage, layout)?, outputs, inputs))
        } else {
            Matrix::Half(HalfMatrix::new(weight)?)
        };
        let on_processor = !matches!(matrix, Matrix::Plain(_));
        let bias = bias.map(|bias| if on_processor { bias.to_dtype(DType::F32) } else { Ok(bias) }).transpose()?;
        Ok(Self { matrix, bias, outputs })
    }

    /// The layer's output for x [.., inputs].
    pub(crate) fn of(&self, x: &Tensor) -> Result<Tensor> {
        self.run(x, None)
    }

    /// The layer's output for x, after an activation.
    pub(crate) fn of_then(&self, x: &Tensor, activation: Activation) -> Result<Tensor> {
        self.run(x, Some(activation))
    }

    fn run(&self, x: &Tensor, activation: Option<Activation>) -> Result<Tensor> {
        if let Matrix::Plain(weight_t) = &self.matrix {
            let y = x.broadcast_matmul(weight_t)?;
            let y = self.bias.as_ref().map_or(Ok(y.clone()), |bias| y.broadcast_add(bias))?;
            return activation.map_or(Ok(y.clone()), |activation| activation.of(&y));
        }
        x.contiguous()?.apply_op1_no_bwd(&Product { layer: self, activation })
    }

    /// Writes the layer's output for the rows of x into y, on the CPU.
    pub(crate) fn rows(&self, x: &[f32], y: &mut [f32]) -> Result<()> {
        self.into(x, y, 0.0)
    }

    /// Adds the layer's output for the rows of x to y, on the CPU.
    pub(crate) fn add_rows(&self, x: &[f32], y: &mut [f32]) -> Result<()> {
        self.into(x, y, 1.0)
    }

    /// The layer's output for the rows of x, plus a multiple of y.
    fn into(&self, x: &[f32], y: &mut [f32], beta: f32) -> Result<()> {
        let count = y.len() / self.outputs.max(1);
        let inputs = x.len() / count.max(1);
        self.with_bias(|bias| match &self.matrix {
            Matrix::Packed(packed) => {
                let x = GemmInputA::Unpacked(NdTensorView::from_data([count, inputs], x));
                let options = Options { bias: bias.map(BiasVector::Row), beta, ..Options::default() };
                product(y, x, GemmInputB::Packed(packed), options)
            }
            Matrix::Half(half) if beta == 0.0 => half.product(x, inputs, bias, y),
            Matrix::Half(half) => {
                let mut more = vec![0.0; y.len()];
                half.product(x, inputs, bias, &mut more)?;
                y.iter_mut().zip(more).for_each(|(y, more)| *y = *y * beta + more);
                Ok(())
            }
            Matrix::Plain(_) => bail!("candle computes this product"),
        })
    }

    /// Calls `then` with the numbers of the bias, if there is one.
    fn with_bias<T>(&self, then: impl FnOnce(Option<&[f32]>) -> Result<T>) -> Result<T> {
        let Some(bias) = &self.bias else { return then(None) };
        let (storage, layout) = bias.storage_and_layout();
        let candle_core::Storage::Cpu(storage) = &*storage else { bail!("a bias is not on its device") };
        then(Some(slice::<f32>(storage, layout)?))
    }
}

/// One product of a layer.
struct Product<'a> {
    layer: &'a Linear,
    activation: Option<Activation>,
}

impl CustomOp1 for Product<'_> {
    fn name(&self) -> &'static str {
        "linear"
    }

    fn cpu_fwd(&self, storage: &CpuStorage, layout: &Layout) -> Result<(CpuStorage, Shape)> {
        let x = slice::<f32>(storage, layout)?;
        let (count, _) = rows(layout)?;
        let outputs = self.layer.outputs;
        let mut y = vec![0.0; count * outputs];
        self.layer.rows(x, &mut y)?;
        if let Some(activation) = self.activation {
            activation.map(&mut y);
        }
        let mut shape = layout.shape().dims().to_vec();
        if let Some(last) = shape.last_mut() {
            *last = outputs;
        }
        Ok((CpuStorage::F32(y), shape.into()))
    }
}

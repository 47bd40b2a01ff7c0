//! Linear layers, with the norm, activation or sum that often comes before or after them in the same pass.

use super::{
    Activation, LayerNorm,
    half::HalfMatrix,
    kernels::{is_ours, rows, slice},
    packed::Packed,
    rows::{by_rows, with_spare},
};
use candle_core::{CpuStorage, CustomOp1, CustomOp2, DType, Layout, Result, Shape, Tensor, bail};

/// Multiplies x [.., inputs] by a matrix and adds a bias: [.., outputs].
pub(crate) struct Linear {
    matrix: Matrix,
    bias: Option<Tensor>,
    outputs: usize,
}

/// The weights in the form that the device computes with. The checkpoint's own tensor is dropped.
enum Matrix {
    /// Packed once for the CPU kernels.
    Packed(Packed),
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
            Matrix::Packed(Packed::new(slice::<f32>(storage, layout)?, outputs, inputs))
        } else {
            Matrix::Half(HalfMatrix::new(weight)?)
        };
        let on_processor = !matches!(matrix, Matrix::Plain(_));
        let bias = bias.map(|bias| if on_processor { bias.to_dtype(DType::F32) } else { Ok(bias) }).transpose()?;
        Ok(Self { matrix, bias, outputs })
    }

    /// The layer's output for x [.., inputs].
    pub(crate) fn of(&self, x: &Tensor) -> Result<Tensor> {
        self.run(x, None, None)
    }

    /// The layer's output for x, after an activation.
    pub(crate) fn of_then(&self, x: &Tensor, activation: Activation) -> Result<Tensor> {
        self.run(x, None, Some(activation))
    }

    /// The layer's output for the norm of x.
    pub(crate) fn of_normed(&self, x: &Tensor, norm: &LayerNorm) -> Result<Tensor> {
        self.run(x, Some(norm), None)
    }

    /// The layer's output for x [.., inputs], plus y [.., outputs].
    pub(crate) fn onto(&self, x: &Tensor, y: &Tensor) -> Result<Tensor> {
        if self.packed().is_some() && is_ours(y) && is_ours(x) {
            return x.contiguous()?.apply_op2_no_bwd(&y.contiguous()?, &Onto { layer: self, after: None });
        }
        self.of(x)? + y
    }

    /// The norm of the layer's output for x [.., inputs], plus y [.., outputs].
    pub(crate) fn onto_then(&self, x: &Tensor, y: &Tensor, after: &LayerNorm) -> Result<Tensor> {
        if self.packed().is_some() && is_ours(y) && is_ours(x) {
            return x.contiguous()?.apply_op2_no_bwd(&y.contiguous()?, &Onto { layer: self, after: Some(after) });
        }
        after.of(&self.onto(x, y)?)
    }

    fn run(&self, x: &Tensor, norm: Option<&LayerNorm>, activation: Option<Activation>) -> Result<Tensor> {
        match (&self.matrix, norm) {
            (Matrix::Packed(_), _) | (Matrix::Half(_), None) => {
                x.contiguous()?.apply_op1_no_bwd(&Product { layer: self, norm, activation })
            }
            (_, Some(norm)) => self.run(&norm.of(x)?, None, activation),
            (Matrix::Plain(weight_t), None) => {
                let y = x.broadcast_matmul(weight_t)?;
                let y = self.bias.as_ref().map_or(Ok(y.clone()), |bias| y.broadcast_add(bias))?;
                activation.map_or(Ok(y.clone()), |activation| activation.of(&y))
            }
        }
    }

    /// Writes the layer's output for the rows of x into y. Only for layers on the CPU.
    pub(crate) fn rows(&self, x: &[f32], y: &mut [f32]) -> Result<()> {
        self.into(x, y, false)
    }

    /// Adds the layer's output for the rows of x to y. Only for layers on the CPU.
    pub(crate) fn add_rows(&self, x: &[f32], y: &mut [f32]) -> Result<()> {
        self.into(x, y, true)
    }

    fn into(&self, x: &[f32], y: &mut [f32], adds: bool) -> Result<()> {
        let inputs = x.len() / (y.len() / self.outputs.max(1)).max(1);
        self.with_bias(|bias| match &self.matrix {
            Matrix::Packed(packed) => packed.product(x, bias, y, adds),
            Matrix::Half(half) if !adds => half.product(x, inputs, bias, y),
            Matrix::Half(half) => {
                let mut more = vec![0.0; y.len()];
                half.product(x, inputs, bias, &mut more)?;
                y.iter_mut().zip(more).for_each(|(y, more)| *y += more);
                Ok(())
            }
            Matrix::Plain(_) => bail!("candle computes this product"),
        })
    }

    /// The weights in the form for the CPU kernels, if they have it.
    pub(super) fn packed(&self) -> Option<&Packed> {
        match &self.matrix {
            Matrix::Packed(packed) => Some(packed),
            Matrix::Half(_) | Matrix::Plain(_) => None,
        }
    }

    /// The number of outputs.
    pub(super) fn outputs(&self) -> usize {
        self.outputs
    }

    /// Calls `then` with the numbers of the bias, if there is one.
    pub(super) fn with_bias<T>(&self, then: impl FnOnce(Option<&[f32]>) -> Result<T>) -> Result<T> {
        let Some(bias) = &self.bias else { return then(None) };
        let (storage, layout) = bias.storage_and_layout();
        let candle_core::Storage::Cpu(storage) = &*storage else { bail!("a bias is not on its device") };
        then(Some(slice::<f32>(storage, layout)?))
    }
}

/// One product of a layer, with a norm before it and an activation after it, as an operator of candle.
struct Product<'a> {
    layer: &'a Linear,
    norm: Option<&'a LayerNorm>,
    activation: Option<Activation>,
}

impl Product<'_> {
    /// Computes y = activation(norm(x) matrix + bias) for some rows.
    fn some(&self, packed: &Packed, bias: Option<&[f32]>, x: &[f32], y: &mut [f32]) -> Result<()> {
        match self.norm {
            None => packed.product(x, bias, y, false)?,
            Some(norm) => with_spare(x.len(), |normed| {
                norm.rows(x, normed)?;
                packed.product(normed, bias, y, false)
            })?,
        }
        if let Some(activation) = self.activation {
            activation.map(y);
        }
        Ok(())
    }
}

impl CustomOp1 for Product<'_> {
    fn name(&self) -> &'static str {
        "linear"
    }

    fn cpu_fwd(&self, storage: &CpuStorage, layout: &Layout) -> Result<(CpuStorage, Shape)> {
        let x = slice::<f32>(storage, layout)?;
        let (count, inputs) = rows(layout)?;
        let outputs = self.layer.outputs;
        let mut y = vec![0.0; count * outputs];
        self.layer.with_bias(|bias| match &self.layer.matrix {
            Matrix::Packed(packed) => by_rows((x, inputs), (&mut y, outputs), |x, y| self.some(packed, bias, x, y)),
            Matrix::Half(half) => {
                half.product(x, inputs, bias, &mut y)?;
                if let Some(activation) = self.activation {
                    activation.map(&mut y);
                }
                Ok(())
            }
            Matrix::Plain(_) => bail!("candle computes this product"),
        })?;
        Ok((CpuStorage::F32(y), wide(layout, outputs)))
    }
}

/// One product of a layer that is added to another tensor, with a norm of the sum, as an operator of candle.
struct Onto<'a> {
    layer: &'a Linear,
    after: Option<&'a LayerNorm>,
}

impl CustomOp2 for Onto<'_> {
    fn name(&self) -> &'static str {
        "linear-onto"
    }

    fn cpu_fwd(
        &self,
        x: &CpuStorage,
        x_layout: &Layout,
        onto: &CpuStorage,
        onto_layout: &Layout,
    ) -> Result<(CpuStorage, Shape)> {
        let (layer, x) = (self.layer, slice::<f32>(x, x_layout)?);
        let (count, inputs) = rows(x_layout)?;
        let mut y = slice::<f32>(onto, onto_layout)?.to_vec();
        let Some(packed) = layer.packed() else { bail!("candle computes this product") };
        if y.len() != count * layer.outputs {
            bail!("{:?} cannot be added to {} rows of {}", onto_layout.shape(), count, layer.outputs);
        }
        layer.with_bias(|bias| {
            by_rows((x, inputs), (&mut y, layer.outputs), |x, y| {
                packed.product(x, bias, y, true)?;
                self.after.map_or(Ok(()), |after| after.rows_here(y))
            })
        })?;
        Ok((CpuStorage::F32(y), wide(x_layout, layer.outputs)))
    }
}

/// The shape of a layer's output.
fn wide(layout: &Layout, outputs: usize) -> Shape {
    let mut shape = layout.shape().dims().to_vec();
    if let Some(last) = shape.last_mut() {
        *last = outputs;
    }
    shape.into()
}

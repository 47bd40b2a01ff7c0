//! Linear layers, with the norm, activation or sum that often comes before or after them in the same pass.

use super::{
    Activation, LayerNorm,
    half::HalfMatrix,
    kernels::{contiguous_slice, is_cpu_f32, row_shape},
    packed::PackedMatrix,
    rows::{for_row_pieces, with_spare_memory},
};
use candle_core::{CpuStorage, CustomOp1, CustomOp2, DType, Layout, Result, Shape, Tensor, bail};

/// Multiplies x [.., inputs] by a matrix and adds a bias: [.., outputs].
pub(crate) struct LinearLayer {
    matrix: LinearMatrix,
    bias: Option<Tensor>,
    outputs: usize,
}

/// The weights in the form that the device computes with. The checkpoint's own tensor is dropped.
enum LinearMatrix {
    /// Packed once for the CPU kernels.
    Packed(PackedMatrix),
    /// In 16 bits on the CPU: widened piece by piece for each product.
    Half(HalfMatrix),
    /// Transposed, for candle.
    Plain(Tensor),
}

impl LinearLayer {
    /// A layer from a checkpoint's weight [outputs, inputs] and bias [outputs].
    pub(crate) fn new(weight: &Tensor, bias: Option<Tensor>) -> Result<Self> {
        let (outputs, inputs) = weight.dims2()?;
        let matrix = if !weight.device().is_cpu() {
            LinearMatrix::Plain(weight.t()?)
        } else if weight.dtype() == DType::F32 {
            let weight = weight.contiguous()?;
            let (storage, layout) = weight.storage_and_layout();
            let candle_core::Storage::Cpu(storage) = &*storage else { bail!("a weight is not on its device") };
            LinearMatrix::Packed(PackedMatrix::new(contiguous_slice::<f32>(storage, layout)?, outputs, inputs))
        } else {
            LinearMatrix::Half(HalfMatrix::new(weight)?)
        };
        let on_cpu = !matches!(matrix, LinearMatrix::Plain(_));
        let bias = bias.map(|bias| if on_cpu { bias.to_dtype(DType::F32) } else { Ok(bias) }).transpose()?;
        Ok(Self { matrix, bias, outputs })
    }

    /// The layer's output for x [.., inputs].
    pub(crate) fn apply_to(&self, x: &Tensor) -> Result<Tensor> {
        self.apply_with(x, None, None)
    }

    /// The layer's output for x, after an activation.
    pub(crate) fn apply_and_activate(&self, x: &Tensor, activation: Activation) -> Result<Tensor> {
        self.apply_with(x, None, Some(activation))
    }

    /// The layer's output for the norm of x.
    pub(crate) fn apply_to_normed(&self, x: &Tensor, norm: &LayerNorm) -> Result<Tensor> {
        self.apply_with(x, Some(norm), None)
    }

    /// The layer's output for x [.., inputs], plus y [.., outputs].
    pub(crate) fn apply_and_add(&self, x: &Tensor, y: &Tensor) -> Result<Tensor> {
        if self.packed_matrix().is_some() && is_cpu_f32(y) && is_cpu_f32(x) {
            return x.contiguous()?.apply_op2_no_bwd(&y.contiguous()?, &AddedProduct { layer: self, after: None });
        }
        self.apply_to(x)? + y
    }

    /// The norm of the layer's output for x [.., inputs], plus y [.., outputs].
    pub(crate) fn apply_add_and_norm(&self, x: &Tensor, y: &Tensor, after: &LayerNorm) -> Result<Tensor> {
        if self.packed_matrix().is_some() && is_cpu_f32(y) && is_cpu_f32(x) {
            return x
                .contiguous()?
                .apply_op2_no_bwd(&y.contiguous()?, &AddedProduct { layer: self, after: Some(after) });
        }
        after.apply_to(&self.apply_and_add(x, y)?)
    }

    /// The layer's output for x, with a norm before the layer and an activation after it.
    fn apply_with(&self, x: &Tensor, norm: Option<&LayerNorm>, activation: Option<Activation>) -> Result<Tensor> {
        match (&self.matrix, norm) {
            (LinearMatrix::Packed(_), _) | (LinearMatrix::Half(_), None) => {
                x.contiguous()?.apply_op1_no_bwd(&LinearProduct { layer: self, norm, activation })
            }
            (_, Some(norm)) => self.apply_with(&norm.apply_to(x)?, None, activation),
            (LinearMatrix::Plain(weight_t), None) => {
                let y = x.broadcast_matmul(weight_t)?;
                let y = self.bias.as_ref().map_or(Ok(y.clone()), |bias| y.broadcast_add(bias))?;
                activation.map_or(Ok(y.clone()), |activation| activation.apply_to(&y))
            }
        }
    }

    /// Writes the layer's output for the rows of x into y. Only for layers on the CPU.
    pub(crate) fn write_rows(&self, x: &[f32], y: &mut [f32]) -> Result<()> {
        self.write_or_add(x, y, false)
    }

    /// Adds the layer's output for the rows of x to y. Only for layers on the CPU.
    pub(crate) fn add_rows(&self, x: &[f32], y: &mut [f32]) -> Result<()> {
        self.write_or_add(x, y, true)
    }

    /// Writes the layer's output for the rows of x into y, or adds it to y if `adds`.
    fn write_or_add(&self, x: &[f32], y: &mut [f32], adds: bool) -> Result<()> {
        let inputs = x.len() / (y.len() / self.outputs.max(1)).max(1);
        self.with_bias(|bias| match &self.matrix {
            LinearMatrix::Packed(packed) => packed.multiply_rows(x, bias, y, adds),
            LinearMatrix::Half(half) if !adds => half.multiply_rows(x, inputs, bias, y),
            LinearMatrix::Half(half) => {
                let mut product = vec![0.0; y.len()];
                half.multiply_rows(x, inputs, bias, &mut product)?;
                y.iter_mut().zip(product).for_each(|(y, product)| *y += product);
                Ok(())
            }
            LinearMatrix::Plain(_) => bail!("candle computes this product"),
        })
    }

    /// The weights in the form for the CPU kernels, if they have it.
    pub(super) fn packed_matrix(&self) -> Option<&PackedMatrix> {
        match &self.matrix {
            LinearMatrix::Packed(packed) => Some(packed),
            LinearMatrix::Half(_) | LinearMatrix::Plain(_) => None,
        }
    }

    /// The number of outputs.
    pub(super) fn output_count(&self) -> usize {
        self.outputs
    }

    /// Calls `then` with the numbers of the bias, if there is one.
    pub(super) fn with_bias<T>(&self, then: impl FnOnce(Option<&[f32]>) -> Result<T>) -> Result<T> {
        let Some(bias) = &self.bias else { return then(None) };
        let (storage, layout) = bias.storage_and_layout();
        let candle_core::Storage::Cpu(storage) = &*storage else { bail!("a bias is not on its device") };
        then(Some(contiguous_slice::<f32>(storage, layout)?))
    }
}

/// One product of a layer, with a norm before it and an activation after it, as an operator of candle.
struct LinearProduct<'a> {
    layer: &'a LinearLayer,
    norm: Option<&'a LayerNorm>,
    activation: Option<Activation>,
}

impl LinearProduct<'_> {
    /// Computes y = activation(norm(x) matrix + bias) for some rows.
    fn write_piece(&self, packed: &PackedMatrix, bias: Option<&[f32]>, x: &[f32], y: &mut [f32]) -> Result<()> {
        match self.norm {
            None => packed.multiply_rows(x, bias, y, false)?,
            Some(norm) => with_spare_memory(x.len(), |normed| {
                norm.write_rows(x, normed)?;
                packed.multiply_rows(normed, bias, y, false)
            })?,
        }
        if let Some(activation) = self.activation {
            activation.map_on_threads(y);
        }
        Ok(())
    }
}

impl CustomOp1 for LinearProduct<'_> {
    fn name(&self) -> &'static str {
        "linear"
    }

    fn cpu_fwd(&self, storage: &CpuStorage, layout: &Layout) -> Result<(CpuStorage, Shape)> {
        let x = contiguous_slice::<f32>(storage, layout)?;
        let (count, inputs) = row_shape(layout)?;
        let outputs = self.layer.outputs;
        let mut y = vec![0.0; count * outputs];
        self.layer.with_bias(|bias| match &self.layer.matrix {
            LinearMatrix::Packed(packed) => {
                for_row_pieces((x, inputs), (&mut y, outputs), |x, y| self.write_piece(packed, bias, x, y))
            }
            LinearMatrix::Half(half) => {
                half.multiply_rows(x, inputs, bias, &mut y)?;
                if let Some(activation) = self.activation {
                    activation.map_on_threads(&mut y);
                }
                Ok(())
            }
            LinearMatrix::Plain(_) => bail!("candle computes this product"),
        })?;
        Ok((CpuStorage::F32(y), output_shape(layout, outputs)))
    }
}

/// One product of a layer that is added to another tensor, with a norm of the sum, as an operator of candle.
struct AddedProduct<'a> {
    layer: &'a LinearLayer,
    after: Option<&'a LayerNorm>,
}

impl CustomOp2 for AddedProduct<'_> {
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
        let (layer, x) = (self.layer, contiguous_slice::<f32>(x, x_layout)?);
        let (count, inputs) = row_shape(x_layout)?;
        let mut y = contiguous_slice::<f32>(onto, onto_layout)?.to_vec();
        let Some(packed) = layer.packed_matrix() else { bail!("candle computes this product") };
        if y.len() != count * layer.outputs {
            bail!("{:?} cannot be added to {} rows of {}", onto_layout.shape(), count, layer.outputs);
        }
        layer.with_bias(|bias| {
            for_row_pieces((x, inputs), (&mut y, layer.outputs), |x, y| {
                packed.multiply_rows(x, bias, y, true)?;
                self.after.map_or(Ok(()), |after| after.replace_rows(y))
            })
        })?;
        Ok((CpuStorage::F32(y), output_shape(x_layout, layer.outputs)))
    }
}

/// The shape of a layer's output.
fn output_shape(layout: &Layout, outputs: usize) -> Shape {
    let mut shape = layout.shape().dims().to_vec();
    if let Some(last) = shape.last_mut() {
        *last = outputs;
    }
    shape.into()
}

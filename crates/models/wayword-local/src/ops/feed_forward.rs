//! The second half of a transformer's layer: two linear layers with an activation between them, a residual, and a norm.

use super::{
    Activation, LayerNorm, LinearLayer,
    kernels::{contiguous_slice, is_cpu_f32, row_shape},
    packed::PackedMatrix,
    rows::{for_row_pieces, with_spare_memory},
};
use candle_core::{CpuStorage, CustomOp1, Layout, Result, Shape, Tensor, bail};

/// Computes `x + narrow(activation(wide(x)))`. With `before`, the input of the wide layer is normalised; with `after`,
/// the sum is.
pub(crate) struct FeedForward<'a> {
    /// The norm of the input of the wide layer.
    pub(crate) before: Option<&'a LayerNorm>,
    /// From the width of x to the inner width, which is larger.
    pub(crate) wide: &'a LinearLayer,
    pub(crate) activation: Activation,
    /// From the inner width back to the width of x.
    pub(crate) narrow: &'a LinearLayer,
    /// The norm of the sum.
    pub(crate) after: Option<&'a LayerNorm>,
}

impl FeedForward<'_> {
    /// The output for x [.., size].
    pub(crate) fn apply_to(&self, x: &Tensor) -> Result<Tensor> {
        match (self.wide.packed_matrix(), self.narrow.packed_matrix()) {
            (Some(_), Some(_)) if is_cpu_f32(x) => x.contiguous()?.apply_op1_no_bwd(self),
            _ => {
                let normed = self.before.map_or(Ok(x.clone()), |before| before.apply_to(x))?;
                let y = self.narrow.apply_and_add(&self.wide.apply_and_activate(&normed, self.activation)?, x)?;
                self.after.map_or(Ok(y.clone()), |after| after.apply_to(&y))
            }
        }
    }

    /// Computes some rows on the CPU: adds the output of the layers to y, which already contains x.
    fn add_to_rows(
        &self,
        (wide, narrow): (&PackedMatrix, &PackedMatrix),
        biases: [Option<&[f32]>; 2],
        x: &[f32],
        y: &mut [f32],
    ) -> Result<()> {
        let inner_count = y.len() / self.narrow.output_count().max(1) * self.wide.output_count();
        with_spare_memory(inner_count, |inner_states| {
            match self.before {
                None => wide.multiply_rows(x, biases[0], inner_states, false)?,
                Some(before) => with_spare_memory(x.len(), |normed| {
                    before.write_rows(x, normed)?;
                    wide.multiply_rows(normed, biases[0], inner_states, false)
                })?,
            }
            self.activation.map_on_threads(inner_states);
            narrow.multiply_rows(inner_states, biases[1], y, true)
        })?;
        self.after.map_or(Ok(()), |after| after.replace_rows(y))
    }
}

impl CustomOp1 for FeedForward<'_> {
    fn name(&self) -> &'static str {
        "feed-forward"
    }

    fn cpu_fwd(&self, storage: &CpuStorage, layout: &Layout) -> Result<(CpuStorage, Shape)> {
        let (Some(wide), Some(narrow)) = (self.wide.packed_matrix(), self.narrow.packed_matrix()) else {
            bail!("candle computes this product")
        };
        let x = contiguous_slice::<f32>(storage, layout)?;
        let (_, size) = row_shape(layout)?;
        if size != self.narrow.output_count() {
            bail!("{} outputs cannot be added to {size}", self.narrow.output_count());
        }
        let mut y = x.to_vec();
        self.wide.with_bias(|first| {
            self.narrow.with_bias(|second| {
                for_row_pieces((x, size), (&mut y, size), |x, y| {
                    self.add_to_rows((wide, narrow), [first, second], x, y)
                })
            })
        })?;
        Ok((CpuStorage::F32(y), layout.shape().clone()))
    }
}

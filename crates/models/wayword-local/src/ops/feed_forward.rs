//! The second half of a transformer's layer: two linear layers with an activation between them, a residual, and a norm.

use super::{
    Activation, LayerNorm, Linear,
    kernels::{is_ours, rows, slice},
    packed::Packed,
    rows::{by_rows, with_spare},
};
use candle_core::{CpuStorage, CustomOp1, Layout, Result, Shape, Tensor, bail};

/// Computes `x + narrow(activation(wide(x)))`. With `before`, the input of the wide layer is normalised; with `after`,
/// the sum is.
pub(crate) struct FeedForward<'a> {
    pub(crate) before: Option<&'a LayerNorm>,
    pub(crate) wide: &'a Linear,
    pub(crate) activation: Activation,
    pub(crate) narrow: &'a Linear,
    pub(crate) after: Option<&'a LayerNorm>,
}

impl FeedForward<'_> {
    pub(crate) fn of(&self, x: &Tensor) -> Result<Tensor> {
        match (self.wide.packed(), self.narrow.packed()) {
            (Some(_), Some(_)) if is_ours(x) => x.contiguous()?.apply_op1_no_bwd(self),
            _ => {
                let normed = self.before.map_or(Ok(x.clone()), |before| before.of(x))?;
                let y = self.narrow.onto(&self.wide.of_then(&normed, self.activation)?, x)?;
                self.after.map_or(Ok(y.clone()), |after| after.of(&y))
            }
        }
    }

    /// Computes some rows on the CPU: adds the output of the layers to y, which already contains x.
    fn some(
        &self,
        (wide, narrow): (&Packed, &Packed),
        biases: [Option<&[f32]>; 2],
        x: &[f32],
        y: &mut [f32],
    ) -> Result<()> {
        let inner = y.len() / self.narrow.outputs().max(1) * self.wide.outputs();
        with_spare(inner, |thought| {
            match self.before {
                None => wide.product(x, biases[0], thought, false)?,
                Some(before) => with_spare(x.len(), |normed| {
                    before.rows(x, normed)?;
                    wide.product(normed, biases[0], thought, false)
                })?,
            }
            self.activation.map(thought);
            narrow.product(thought, biases[1], y, true)
        })?;
        self.after.map_or(Ok(()), |after| after.rows_here(y))
    }
}

impl CustomOp1 for FeedForward<'_> {
    fn name(&self) -> &'static str {
        "feed-forward"
    }

    fn cpu_fwd(&self, storage: &CpuStorage, layout: &Layout) -> Result<(CpuStorage, Shape)> {
        let (Some(wide), Some(narrow)) = (self.wide.packed(), self.narrow.packed()) else {
            bail!("candle computes this product")
        };
        let x = slice::<f32>(storage, layout)?;
        let (_, size) = rows(layout)?;
        if size != self.narrow.outputs() {
            bail!("{} outputs cannot be added to {size}", self.narrow.outputs());
        }
        let mut y = x.to_vec();
        self.wide.with_bias(|first| {
            self.narrow.with_bias(|second| {
                by_rows((x, size), (&mut y, size), |x, y| self.some((wide, narrow), [first, second], x, y))
            })
        })?;
        Ok((CpuStorage::F32(y), layout.shape().clone()))
    }
}

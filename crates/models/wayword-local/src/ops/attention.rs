//! Multi-head attention.

use super::kernels::{Options, is_ours, product, slice};
use candle_core::{CpuStorage, CustomOp3, Device, Layout, Result, Shape, Tensor, bail};
use rayon::prelude::*;
use rten_gemm::{GemmInputA, GemmInputB};
use rten_simd::SimdOp;
use rten_tensor::NdTensorView;
use rten_vecmath::Softmax;

/// softmax(q kᵀ * scale + bias) v, for each head.
pub(crate) struct Attention<'a> {
    pub(crate) heads: usize,
    pub(crate) scale: f32,
    /// Added to the scores, broadcast to [batch, heads, queries, keys]: a mask of 0 and -inf, or a bias by position.
    pub(crate) bias: Option<&'a Tensor>,
}

impl Attention<'_> {
    /// From queries [batch, queries, heads * size] and keys and values [batch, keys, heads * size], states
    /// [batch, queries, heads * size]. The inputs may be parts of a wider tensor along its last axis.
    pub(crate) fn of(&self, q: &Tensor, k: &Tensor, v: &Tensor) -> Result<Tensor> {
        if is_ours(q) {
            return match self.bias {
                None => q.apply_op3_no_bwd(k, v, &Heads { heads: self.heads, scale: self.scale, bias: None }),
                Some(bias) => {
                    let (batch, queries, _) = q.dims3()?;
                    let shape = (batch, self.heads, queries, k.dim(1)?);
                    let bias = bias.broadcast_as(shape)?.contiguous()?;
                    let (storage, layout) = bias.storage_and_layout();
                    let candle_core::Storage::Cpu(storage) = &*storage else { bail!("a mask is on another device") };
                    let bias = Some(slice::<f32>(storage, layout)?);
                    q.apply_op3_no_bwd(k, v, &Heads { heads: self.heads, scale: self.scale, bias })
                }
            };
        }
        let split = |x: &Tensor| -> Result<Tensor> {
            let (batch, count, width) = x.dims3()?;
            x.reshape((batch, count, self.heads, width / self.heads))?.transpose(1, 2)?.contiguous()
        };
        let scores = (split(q)?.matmul(&split(k)?.t()?)? * f64::from(self.scale))?;
        let scores = match self.bias {
            None => scores,
            Some(bias) => scores.broadcast_add(&bias.to_dtype(scores.dtype())?)?,
        };
        let mixed = candle_nn::ops::softmax_last_dim(&scores)?.matmul(&split(v)?)?;
        mixed.transpose(1, 2)?.flatten_from(2)
    }
}

/// One layer's keys and values [batch, tokens, width] of the tokens so far, so that each is computed once.
#[derive(Debug, Clone, Default)]
pub(crate) struct Past(Option<(Tensor, Tensor)>);

impl Past {
    /// How many tokens there are.
    pub(crate) fn len(&self) -> Result<usize> {
        self.0.as_ref().map_or(Ok(0), |(keys, _)| keys.dim(1))
    }

    /// Adds the keys and values of the next tokens, and returns all.
    pub(crate) fn grow(&mut self, keys: Tensor, values: Tensor) -> Result<(Tensor, Tensor)> {
        let grown = match self.0.take() {
            None => (keys, values),
            Some((old_keys, old_values)) => {
                (Tensor::cat(&[old_keys, keys], 1)?, Tensor::cat(&[old_values, values], 1)?)
            }
        };
        self.0 = Some(grown.clone());
        Ok(grown)
    }
}

/// A mask [queries, keys] with which a query sees itself and everything before it. The last query is the last key.
pub(crate) fn causal(queries: usize, keys: usize, device: &Device) -> Result<Tensor> {
    let before = keys - queries.min(keys);
    let sees = |at: usize| if at % keys <= at / keys + before { 0.0 } else { f32::NEG_INFINITY };
    Tensor::from_vec((0..queries * keys).map(sees).collect(), (queries, keys), device)
}

struct Heads<'a> {
    heads: usize,
    scale: f32,
    /// [batch, heads, queries, keys].
    bias: Option<&'a [f32]>,
}

/// A tensor [batch, count, width], which may be a part of a wider one.
struct Rows<'a> {
    numbers: &'a [f32],
    batch: usize,
    count: usize,
    width: usize,
    batch_step: usize,
    row_step: usize,
}

impl<'a> Rows<'a> {
    fn new(storage: &'a CpuStorage, layout: &Layout) -> Result<Self> {
        let (batch, count, width) = layout.shape().dims3()?;
        let &[batch_step, row_step, 1] = layout.stride() else { bail!("the last axis is not contiguous") };
        let numbers = storage.as_slice::<f32>()?.get(layout.start_offset()..).unwrap_or_default();
        Ok(Self { numbers, batch, count, width, batch_step, row_step })
    }

    /// One head of one batch, [count, size].
    fn head(&self, batch: usize, head: usize, heads: usize) -> Result<NdTensorView<'a, f32, 2>> {
        let size = self.width / heads;
        let from = batch * self.batch_step + head * size;
        let to = from + self.count.saturating_sub(1) * self.row_step + size;
        let Some(numbers) = self.numbers.get(from..to) else { bail!("a tensor has fewer numbers than its shape") };
        NdTensorView::from_data_with_strides([self.count, size], numbers, [self.row_step, 1])
            .map_err(candle_core::Error::wrap)
    }
}

impl Heads<'_> {
    /// One head of one batch: [queries, size].
    fn head(&self, q: &Rows<'_>, k: &Rows<'_>, v: &Rows<'_>, at: usize) -> Result<Vec<f32>> {
        let (batch, head) = (at / self.heads, at % self.heads);
        let (queries, keys) = (q.count, k.count);
        let mut scores = vec![0.0; queries * keys];
        let a = GemmInputA::Unpacked(q.head(batch, head, self.heads)?);
        let b = k.head(batch, head, self.heads)?;
        let options = Options { alpha: self.scale, ..Options::default() };
        product(&mut scores, a, GemmInputB::Unpacked(b.transposed()), options)?;
        if let Some(bias) = self.bias {
            let bias = &bias[at * queries * keys..(at + 1) * queries * keys];
            scores.iter_mut().zip(bias).for_each(|(score, bias)| *score += bias);
        }
        for row in scores.chunks_mut(keys) {
            Softmax::new_mut(row).dispatch();
        }
        let mut mixed = vec![0.0; queries * v.width / self.heads];
        let a = GemmInputA::Unpacked(NdTensorView::from_data([queries, keys], &scores[..]));
        let b = GemmInputB::Unpacked(v.head(batch, head, self.heads)?);
        product(&mut mixed, a, b, Options::default())?;
        Ok(mixed)
    }
}

impl CustomOp3 for Heads<'_> {
    fn name(&self) -> &'static str {
        "attention"
    }

    fn cpu_fwd(
        &self,
        q: &CpuStorage,
        q_layout: &Layout,
        k: &CpuStorage,
        k_layout: &Layout,
        v: &CpuStorage,
        v_layout: &Layout,
    ) -> Result<(CpuStorage, Shape)> {
        let (q, k, v) = (Rows::new(q, q_layout)?, Rows::new(k, k_layout)?, Rows::new(v, v_layout)?);
        if k.batch != q.batch || v.batch != q.batch || v.count != k.count || k.width != q.width || k.count == 0 {
            bail!("queries {:?}, keys {:?} and values {:?} do not fit together", q_layout, k_layout, v_layout);
        }
        let heads: Vec<Vec<f32>> =
            (0..q.batch * self.heads).into_par_iter().map(|at| self.head(&q, &k, &v, at)).collect::<Result<_>>()?;
        let size = v.width / self.heads;
        let mut mixed = vec![0.0; q.batch * q.count * v.width];
        for (at, head) in heads.iter().enumerate() {
            let from = at / self.heads * q.count * v.width + at % self.heads * size;
            for (row, numbers) in head.chunks(size).enumerate() {
                let from = from + row * v.width;
                mixed[from..from + size].copy_from_slice(numbers);
            }
        }
        Ok((CpuStorage::F32(mixed), (q.batch, q.count, v.width).into()))
    }
}

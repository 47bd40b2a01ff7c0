//! Multi-head attention.
//!
//! On the CPU a thread takes some queries of one batch at a time. It computes their scores for a head, the softmax, and
//! the mix of values before it goes on, so that the scores, which would be a large tensor, stay in the cache and are
//! never stored.

use super::{
    kernels::{ProductOptions, contiguous_slice, is_cpu_f32, pack_matrix, write_product},
    rows::with_spare_memory,
    softmax::replace_by_exponentials,
};
use candle_core::{CpuStorage, CustomOp3, Device, Layout, Result, Shape, Tensor, bail};
use rayon::prelude::*;
use rten_gemm::{GemmInputA, GemmInputB, PackedBMatrix};
use rten_tensor::NdTensorView;
use std::ops::Range;

/// The most scores that a thread computes at a time: about as many as fit into a core's cache.
const MAX_SCORES_AT_A_TIME: usize = 384 << 10;

/// The most queries that a thread takes at a time, however few keys there are.
const MAX_QUERIES_AT_A_TIME: usize = 96;

/// The fewest queries at a time for which keys and values are packed beforehand. For fewer, packing costs more time
/// than it saves.
const MIN_PACKED_QUERIES: usize = 24;

/// softmax(q kᵀ * scale + bias) v, for each head.
pub(crate) struct MultiHeadAttention<'a> {
    pub(crate) heads: usize,
    pub(crate) scale: f32,
    /// Added to the scores, broadcast to [batch, heads, queries, keys]: a mask of 0 and -inf, or a bias by position.
    pub(crate) bias: Option<&'a Tensor>,
}

impl MultiHeadAttention<'_> {
    /// The states [batch, queries, heads * size] for queries of the same shape, and keys and values [batch, keys, heads
    /// * size]. The inputs may be parts of a wider tensor along its last axis.
    pub(crate) fn attend_to(&self, q: &Tensor, k: &Tensor, v: &Tensor) -> Result<Tensor> {
        if is_cpu_f32(q) {
            return match self.bias {
                None => q.apply_op3_no_bwd(k, v, &CpuAttention { heads: self.heads, scale: self.scale, bias: None }),
                Some(bias) => {
                    let (batch, queries, _) = q.dims3()?;
                    let shape = (batch, self.heads, queries, k.dim(1)?);
                    let bias = bias.broadcast_as(shape)?.contiguous()?;
                    let (storage, layout) = bias.storage_and_layout();
                    let candle_core::Storage::Cpu(storage) = &*storage else { bail!("a mask is on another device") };
                    let bias = Some(contiguous_slice::<f32>(storage, layout)?);
                    q.apply_op3_no_bwd(k, v, &CpuAttention { heads: self.heads, scale: self.scale, bias })
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

/// The keys and values [batch, tokens, width] of one layer, for the tokens so far. A decoder that writes token by token
/// keeps them, so that each is computed once.
#[derive(Debug, Clone, Default)]
pub(crate) struct KeyValueCache(Option<(Tensor, Tensor)>);

impl KeyValueCache {
    /// The number of tokens so far.
    pub(crate) fn len(&self) -> Result<usize> {
        self.0.as_ref().map_or(Ok(0), |(keys, _)| keys.dim(1))
    }

    /// Adds the keys and values of the next tokens, and returns those of all tokens so far.
    pub(crate) fn append_tokens(&mut self, keys: Tensor, values: Tensor) -> Result<(Tensor, Tensor)> {
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

/// A mask [queries, keys] that hides all later keys from a query. The last query belongs to the last key.
pub(crate) fn causal_mask(queries: usize, keys: usize, device: &Device) -> Result<Tensor> {
    let before = keys - queries.min(keys);
    let sees = |at: usize| if at % keys <= at / keys + before { 0.0 } else { f32::NEG_INFINITY };
    Tensor::from_vec((0..queries * keys).map(sees).collect(), (queries, keys), device)
}

/// [`MultiHeadAttention`] on the CPU, as an operator of candle.
struct CpuAttention<'a> {
    heads: usize,
    scale: f32,
    /// Added to the scores, [batch, heads, queries, keys].
    bias: Option<&'a [f32]>,
}

/// A view of a tensor [batch, count, width], which may be a part of a wider one. The steps are numbers from one batch
/// or row to the next.
struct StridedRows<'a> {
    numbers: &'a [f32],
    batch: usize,
    count: usize,
    width: usize,
    batch_step: usize,
    row_step: usize,
}

impl<'a> StridedRows<'a> {
    fn new(storage: &'a CpuStorage, layout: &Layout) -> Result<Self> {
        let (batch, count, width) = layout.shape().dims3()?;
        let &[batch_step, row_step, 1] = layout.stride() else { bail!("the last axis is not contiguous") };
        let numbers = storage.as_slice::<f32>()?.get(layout.start_offset()..).unwrap_or_default();
        Ok(Self { numbers, batch, count, width, batch_step, row_step })
    }

    /// Some rows of one head of one batch, [rows, size].
    fn head_rows(
        &self,
        batch: usize,
        head: usize,
        heads: usize,
        rows: Range<usize>,
    ) -> Result<NdTensorView<'a, f32, 2>> {
        let size = self.width / heads;
        let from = batch * self.batch_step + rows.start * self.row_step + head * size;
        let to = from + rows.len().saturating_sub(1) * self.row_step + size;
        let Some(numbers) = self.numbers.get(from..to) else { bail!("a tensor has fewer numbers than its shape") };
        NdTensorView::from_data_with_strides([rows.len(), size], numbers, [self.row_step, 1])
            .map_err(candle_core::Error::wrap)
    }
}

/// The keys, transposed, and the values of a head, packed once for all queries. Where there are none, each product
/// packs them itself.
type PackedKeysValues = (PackedBMatrix<f32>, PackedBMatrix<f32>);

impl CpuAttention<'_> {
    /// Writes the states of some queries, from query `from` of a batch on, into `mixed` [queries, width].
    fn attend_piece(
        &self,
        inputs: &AttentionInputs<'_>,
        packed: &[PackedKeysValues],
        batch: usize,
        from: usize,
        mixed: &mut [f32],
    ) -> Result<()> {
        let (width, keys) = (inputs.v.width, inputs.k.count);
        let (size, queries) = (width / self.heads, mixed.len() / width.max(1));
        with_spare_memory(queries * keys, |scores| {
            with_spare_memory(queries * size, |states| {
                for head in 0..self.heads {
                    let at = batch * self.heads + head;
                    let q = GemmInputA::Unpacked(inputs.q.head_rows(batch, head, self.heads, from..from + queries)?);
                    let (k, v) = match packed.get(at) {
                        Some((k, v)) => (GemmInputB::Packed(k), GemmInputB::Packed(v)),
                        None => (
                            GemmInputB::Unpacked(inputs.k.head_rows(batch, head, self.heads, 0..keys)?.transposed()),
                            GemmInputB::Unpacked(inputs.v.head_rows(batch, head, self.heads, 0..keys)?),
                        ),
                    };
                    write_product(scores, q, k, ProductOptions { alpha: self.scale, ..ProductOptions::default() })?;
                    if let Some(bias) = self.bias {
                        let bias = &bias[(at * inputs.q.count + from) * keys..];
                        scores.iter_mut().zip(bias).for_each(|(score, bias)| *score += bias);
                    }
                    // The division by the sum comes after the product with the values, where there are fewer numbers.
                    let sums: Vec<f32> = scores.chunks_mut(keys).map(replace_by_exponentials).collect();
                    let scores = GemmInputA::Unpacked(NdTensorView::from_data([queries, keys], &*scores));
                    write_product(states, scores, v, ProductOptions::default())?;
                    for ((to, state), sum) in mixed.chunks_mut(width).zip(states.chunks(size)).zip(sums) {
                        let to = &mut to[head * size..(head + 1) * size];
                        to.iter_mut().zip(state).for_each(|(to, state)| *to = state / sum);
                    }
                }
                Ok(())
            })
        })
    }

    /// Packs the keys and values of all heads, if several pieces of the queries use them. Otherwise returns an empty
    /// list.
    fn pack_heads(&self, inputs: &AttentionInputs<'_>, queries: usize) -> Result<Vec<PackedKeysValues>> {
        if queries >= inputs.q.count || queries < MIN_PACKED_QUERIES {
            return Ok(Vec::new());
        }
        let pack_head = |at: usize| {
            let (batch, head) = (at / self.heads, at % self.heads);
            let k = inputs.k.head_rows(batch, head, self.heads, 0..inputs.k.count)?;
            Ok((
                pack_matrix(k.transposed()),
                pack_matrix(inputs.v.head_rows(batch, head, self.heads, 0..inputs.v.count)?),
            ))
        };
        (0..inputs.q.batch * self.heads).into_par_iter().map(pack_head).collect()
    }
}

/// Queries, keys and values.
struct AttentionInputs<'a> {
    q: StridedRows<'a>,
    k: StridedRows<'a>,
    v: StridedRows<'a>,
}

impl AttentionInputs<'_> {
    /// The number of queries of a batch that a thread takes at a time: so few that their scores stay in the cache, and
    /// that every thread has work.
    fn queries_per_piece(&self) -> usize {
        let min_pieces = rayon::current_num_threads().div_ceil(self.q.batch.max(1));
        (MAX_SCORES_AT_A_TIME / self.k.count.max(1))
            .clamp(MIN_PACKED_QUERIES, MAX_QUERIES_AT_A_TIME)
            .min(self.q.count.div_ceil(min_pieces))
            .max(1)
    }
}

impl CustomOp3 for CpuAttention<'_> {
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
        let inputs = AttentionInputs {
            q: StridedRows::new(q, q_layout)?,
            k: StridedRows::new(k, k_layout)?,
            v: StridedRows::new(v, v_layout)?,
        };
        let AttentionInputs { q, k, v } = &inputs;
        let fit = k.batch == q.batch && v.batch == q.batch && v.count == k.count && k.width == q.width;
        if !fit || k.count == 0 || v.width < self.heads {
            bail!("queries {:?}, keys {:?} and values {:?} do not fit together", q_layout, k_layout, v_layout);
        }
        let mut mixed = vec![0.0; q.batch * q.count * v.width];
        let queries = inputs.queries_per_piece();
        let packed = self.pack_heads(&inputs, queries)?;
        let batches = mixed.par_chunks_mut((q.count * v.width).max(1)).enumerate();
        let pieces = batches.flat_map(|(batch, mixed)| {
            let pieces = mixed.par_chunks_mut(queries * v.width).with_max_len(1).enumerate();
            pieces.map(move |(at, mixed)| (batch, at * queries, mixed))
        });
        pieces.try_for_each(|(batch, from, mixed)| self.attend_piece(&inputs, &packed, batch, from, mixed))?;
        Ok((CpuStorage::F32(mixed), (q.batch, q.count, v.width).into()))
    }
}

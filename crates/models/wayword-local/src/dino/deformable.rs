//! Multi-scale deformable attention: each query looks at a few places of each level, which it chooses itself.
//!
//! Ordinary attention would compare every query with every cell, several thousand of them. Here a linear layer turns
//! the query into a few offsets and weights. The values at these places, interpolated between cells, are added with the
//! weights.

use super::{config::LayersConfig, features::FeatureLevel};
use crate::{
    LocalError,
    ops::{LinearLayer, kernels::contiguous_slice},
    weights::WeightScope,
};
use candle_core::{CpuStorage, CustomOp2, DType, Layout, Result, Shape, Tensor, bail};
use rayon::prelude::*;

/// The number of queries that a thread computes at a time.
const QUERIES_PER_TASK: usize = 64;

/// Deformable attention of one layer.
pub(super) struct DeformableAttention {
    /// Turns the state of a cell into the values that queries sample.
    value: LinearLayer,
    /// The outputs are two offsets for each head, level and point; then a weight for each head, level and point.
    points: LinearLayer,
    out: LinearLayer,
    shape: SamplingShape,
}

/// How many places a query looks at: `points` for each head and level.
#[derive(Debug, Clone, Copy)]
struct SamplingShape {
    heads: usize,
    levels: usize,
    points: usize,
}

/// The places from which the offsets of queries count.
#[derive(Clone, Copy)]
pub(super) enum SamplingOrigin<'a> {
    /// The queries are the cells of all levels, each with its own middle. An offset of 1 is one cell of the sampled
    /// level.
    Cells,
    /// Each query has a box: middle, width and height, as shares of the picture. An offset of 1 from the middle is half
    /// of the box, divided by the number of points.
    Boxes(&'a [[f32; 4]]),
}

impl DeformableAttention {
    pub(super) fn from_weights(
        weights: &WeightScope<'_>,
        size: usize,
        levels: usize,
        config: LayersConfig,
    ) -> std::result::Result<Self, LocalError> {
        let shape = SamplingShape { heads: config.heads, levels, points: config.points };
        let count = shape.sample_count();
        let (offsets, shares) = (weights.sub_scope("sampling_offsets"), weights.sub_scope("attention_weights"));
        let weight =
            [offsets.read_tensor("weight", &[2 * count, size])?, shares.read_tensor("weight", &[count, size])?];
        let bias = [offsets.read_tensor("bias", &[2 * count])?, shares.read_tensor("bias", &[count])?];
        let points = Tensor::cat(&weight, 0).and_then(|weight| LinearLayer::new(&weight, Some(Tensor::cat(&bias, 0)?)));
        Ok(Self {
            value: weights.read_linear("value_proj", size, size)?,
            points: points.map_err(|error| offsets.tensor_error("weight", &error))?,
            out: weights.read_linear("output_proj", size, size)?,
            shape,
        })
    }

    /// The sums [1, queries, size] of the values that the queries sample from the cells [1, cells, size].
    pub(super) fn sample_cells(
        &self,
        queries: &Tensor,
        cells: &Tensor,
        levels: &[FeatureLevel],
        from: SamplingOrigin<'_>,
    ) -> Result<Tensor> {
        let value = self.value.apply_to(cells)?.squeeze(0)?;
        let points = self.points.apply_to(queries)?.squeeze(0)?;
        let from = sampling_starts(from, levels, self.shape.points);
        let mixed = if value.device().is_cpu() {
            let sampler = DeformableSampler { shape: self.shape, levels, from: &from };
            value.contiguous()?.apply_op2_no_bwd(&points.contiguous()?, &sampler)?
        } else {
            sample_on_device(self.shape, &value, &points, levels, &from)?
        };
        self.out.apply_to(&mixed.unsqueeze(0)?)
    }
}

impl SamplingShape {
    /// The number of places that a query looks at, over all heads and levels.
    fn sample_count(self) -> usize {
        self.heads * self.levels * self.points
    }
}

/// The place from which a query's offsets count, as shares of the picture, and the length of an offset of 1: a share of
/// the picture, or one cell if it is `None`.
type SamplingStart = ([f32; 2], Option<[f32; 2]>);

fn sampling_starts(from: SamplingOrigin<'_>, levels: &[FeatureLevel], points: usize) -> Vec<SamplingStart> {
    match from {
        SamplingOrigin::Boxes(boxes) => {
            let step = |edge: f32| 0.5 * edge / points as f32;
            boxes.iter().map(|&[x, y, width, height]| ([x, y], Some([step(width), step(height)]))).collect()
        }
        SamplingOrigin::Cells => {
            levels.iter().flat_map(|level| level.cell_middles().map(|middle| (middle, None))).collect()
        }
    }
}

/// The position of a sample in a level, in cells from the middle of the first cell.
fn sample_position((from, step): SamplingStart, level: FeatureLevel, offset: [f32; 2]) -> (f32, f32) {
    let (width, height) = (level.width as f32, level.height as f32);
    match step {
        None => (from[0] * width + offset[0] - 0.5, from[1] * height + offset[1] - 0.5),
        Some(step) => ((from[0] + offset[0] * step[0]) * width - 0.5, (from[1] + offset[1] * step[1]) * height - 0.5),
    }
}

/// Samples for all queries in one pass on the processor.
struct DeformableSampler<'a> {
    shape: SamplingShape,
    levels: &'a [FeatureLevel],
    from: &'a [SamplingStart],
}

impl CustomOp2 for DeformableSampler<'_> {
    fn name(&self) -> &'static str {
        "deformable-attention"
    }

    fn cpu_fwd(
        &self,
        v: &CpuStorage,
        v_layout: &Layout,
        p: &CpuStorage,
        p_layout: &Layout,
    ) -> Result<(CpuStorage, Shape)> {
        let ((cells, size), (queries, width)) = (v_layout.shape().dims2()?, p_layout.shape().dims2()?);
        let level_cells: usize = self.levels.iter().map(|level| level.height * level.width).sum();
        if level_cells != cells || self.from.len() != queries || width != 3 * self.shape.sample_count() {
            bail!("{cells} cells and {queries} queries do not fit together");
        }
        let (values, points) = (contiguous_slice::<f32>(v, v_layout)?, contiguous_slice::<f32>(p, p_layout)?);
        let mut mixed = vec![0.0; queries * size];
        let pieces = mixed
            .par_chunks_mut(QUERIES_PER_TASK * size)
            .zip(points.par_chunks(QUERIES_PER_TASK * width))
            .zip(self.from.par_chunks(QUERIES_PER_TASK));
        pieces.for_each(|((mixed, points), from)| {
            let mut shares = vec![0.0; self.shape.levels * self.shape.points];
            for ((mixed, points), &from) in mixed.chunks_mut(size).zip(points.chunks(width)).zip(from) {
                self.sample_query(values, points, from, &mut shares, mixed);
            }
        });
        Ok((CpuStorage::F32(mixed), (queries, size).into()))
    }
}

impl DeformableSampler<'_> {
    /// Writes the sum for one query into `mixed`: for each head, the values at its places times their weights. `points`
    /// has the offsets and then the weights before their softmax; `shares` is memory for the weights of one head.
    fn sample_query(&self, values: &[f32], points: &[f32], from: SamplingStart, shares: &mut [f32], mixed: &mut [f32]) {
        let head_width = mixed.len() / self.shape.heads;
        let size = mixed.len();
        let (offsets, weights) = points.split_at(2 * self.shape.sample_count());
        let heads = offsets.chunks(2 * shares.len()).zip(weights.chunks(shares.len()));
        for (head, ((offsets, weights), mixed)) in heads.zip(mixed.chunks_mut(head_width)).enumerate() {
            softmax_into(weights, shares);
            let mut begin = 0;
            let level_points = offsets.chunks(2 * self.shape.points).zip(shares.chunks(self.shape.points));
            for (&level, (offsets, shares)) in self.levels.iter().zip(level_points) {
                let cells = level.height * level.width;
                let map = HeadValueMap {
                    values: &values[begin * size..(begin + cells) * size],
                    level,
                    size,
                    from: head * head_width,
                };
                for (offset, &share) in offsets.chunks(2).zip(shares) {
                    let (x, y) = sample_position(from, level, [offset[0], offset[1]]);
                    map.add_interpolated(x, y, share, mixed);
                }
                begin += cells;
            }
        }
    }
}

fn softmax_into(weights: &[f32], shares: &mut [f32]) {
    let largest = weights.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let mut sum = 0.0;
    for (share, weight) in shares.iter_mut().zip(weights) {
        *share = (weight - largest).exp();
        sum += *share;
    }
    shares.iter_mut().for_each(|share| *share /= sum);
}

/// One head's values of one level.
struct HeadValueMap<'a> {
    values: &'a [f32],
    level: FeatureLevel,
    /// The numbers from one cell to the next: those of all heads.
    size: usize,
    /// The index of the head's first value within a cell.
    from: usize,
}

impl HeadValueMap<'_> {
    /// Adds the value at a place, interpolated between four cells and times `share`, to a sum. Outside of the map
    /// values are 0.
    fn add_interpolated(&self, x: f32, y: f32, share: f32, sum: &mut [f32]) {
        let (width, height) = (self.level.width, self.level.height);
        if !(x > -1.0 && y > -1.0 && x < width as f32 && y < height as f32) {
            return;
        }
        let (left, top) = (x.floor(), y.floor());
        let (right_share, low_share) = (x - left, y - top);
        // A cell outside of the map has the weight 0, so its index may be that of any other cell.
        let neighbours = |at: f32, count: usize, share: f32| {
            let first = at as isize;
            let is_in = |at: isize| if at >= 0 && at < count as isize { 1.0 } else { 0.0 };
            let inside = |at: isize| at.clamp(0, count as isize - 1) as usize;
            ([inside(first), inside(first + 1)], [(1.0 - share) * is_in(first), share * is_in(first + 1)])
        };
        let (columns, across) = neighbours(left, width, right_share);
        let (rows, down) = neighbours(top, height, low_share);
        let cell = |row: usize, column: usize| {
            let begin = (rows[row] * width + columns[column]) * self.size + self.from;
            (&self.values[begin..begin + sum.len()], share * down[row] * across[column])
        };
        let ((a, weight_a), (b, weight_b), (c, weight_c), (d, weight_d)) =
            (cell(0, 0), cell(0, 1), cell(1, 0), cell(1, 1));
        for ((((sum, a), b), c), d) in sum.iter_mut().zip(a).zip(b).zip(c).zip(d) {
            *sum += a * weight_a + b * weight_b + c * weight_c + d * weight_d;
        }
    }
}

/// Samples with candle's operators, for any device. Its result is that of [`DeformableSampler`].
fn sample_on_device(
    shape: SamplingShape,
    value: &Tensor,
    points: &Tensor,
    levels: &[FeatureLevel],
    from: &[SamplingStart],
) -> Result<Tensor> {
    let (device, dtype) = (value.device(), value.dtype());
    let ((cells, size), queries) = (value.dims2()?, points.dim(0)?);
    let SamplingShape { heads, levels: _, points: count } = shape;
    let rows = value.reshape((cells * heads, size / heads))?;
    let points = points.to_dtype(DType::F32)?;
    let offsets = points.narrow(1, 0, 2 * shape.sample_count())?.reshape((queries, heads, levels.len() * count, 2))?;
    let shares = points.narrow(1, 2 * shape.sample_count(), shape.sample_count())?.reshape((
        queries,
        heads,
        levels.len() * count,
    ))?;
    let shares = candle_nn::ops::softmax_last_dim(&shares.contiguous()?)?;
    let head = Tensor::arange(0, heads as u32, device)?.to_dtype(DType::F32)?;
    let mut sum = Tensor::zeros((queries * heads, size / heads), dtype, device)?;
    let mut begin = 0;
    for (at, &level) in levels.iter().enumerate() {
        // The start of each query and the length of an offset of 1, in cells of this level.
        let axis = |axis: usize, length: usize| -> Result<(Tensor, Tensor)> {
            let length = length as f32;
            let middle = from.iter().map(|(from, _)| from[axis] * length - 0.5).collect();
            let step = from.iter().map(|(_, step)| step.map_or(1.0, |step| step[axis] * length)).collect();
            Ok((Tensor::from_vec(middle, (queries, 1), device)?, Tensor::from_vec(step, (queries, 1), device)?))
        };
        let ((from_x, step_x), (from_y, step_y)) = (axis(0, level.width)?, axis(1, level.height)?);
        for point in at * count..(at + 1) * count {
            let offset = |axis: usize| offsets.narrow(2, point, 1)?.narrow(3, axis, 1)?.reshape((queries, heads));
            let x = offset(0)?.broadcast_mul(&step_x)?.broadcast_add(&from_x)?;
            let y = offset(1)?.broadcast_mul(&step_y)?.broadcast_add(&from_y)?;
            let share = shares.narrow(2, point, 1)?.reshape((queries, heads))?;
            let (left, top) = (x.floor()?, y.floor()?);
            for (right, low) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
                let (column, row) = ((&left + right)?, (&top + low)?);
                let part = |at: &Tensor, cell: &Tensor, length: usize| {
                    let inside = (cell.ge(0.0)? * cell.lt(length as f64)?)?.to_dtype(DType::F32)?;
                    (1.0 - (at - cell)?.abs()?)? * inside
                };
                let weight = (part(&x, &column, level.width)? * part(&y, &row, level.height)? * &share)?;
                let column = column.clamp(0.0, level.width as f64 - 1.0)?;
                let row = row.clamp(0.0, level.height as f64 - 1.0)?;
                let cell = ((row * level.width as f64)? + column)?;
                let cell = ((cell + begin as f64)? * heads as f64)?.broadcast_add(&head)?;
                let taken = rows.index_select(&cell.to_dtype(DType::U32)?.flatten_all()?, 0)?;
                sum = (sum + taken.broadcast_mul(&weight.reshape((queries * heads, 1))?.to_dtype(dtype)?)?)?;
            }
        }
        begin += level.height * level.width;
    }
    sum.reshape((queries, size))
}

#[cfg(test)]
mod tests;

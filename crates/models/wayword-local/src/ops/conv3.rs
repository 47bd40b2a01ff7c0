//! Convolutions of 3 x 3 over channels-last maps, plain and deformed.
//!
//! A convolution reads nine positions, the taps of the kernel, for each output position. A deformed one (arXiv
//! 1811.11168) moves each tap by an offset that another layer computed, and multiplies it by a mask. On the CPU the
//! taps of a tile of positions are copied side by side and multiplied with the kernel while they are in the cache.
//! Other devices do the same for the whole map with candle's operators.

use super::{
    LinearLayer,
    kernels::{is_cpu_f32, with_f32_slice},
    tiles::{each_tile, split_memory},
};
use crate::{LocalError, weights::WeightScope};
use candle_core::{Result, Tensor};

/// The number of taps of a kernel. They are numbered row by row.
const KERNEL_TAPS: usize = 9;

/// The numbers that a deformed convolution needs for each position: two offsets (down, across) for each tap, then a
/// mask for each tap.
pub(crate) const OFFSET_NUMBERS_PER_POSITION: usize = 3 * KERNEL_TAPS;

/// A map of features: [height * width, channels], rows from the top.
#[derive(Clone)]
pub(crate) struct FeatureMap {
    pub(crate) x: Tensor,
    pub(crate) height: usize,
    pub(crate) width: usize,
}

/// A convolution of 3 x 3 with a padding of 1.
pub(crate) struct Conv3Layer {
    /// The kernel as a layer from the taps of a position, side by side, to its outputs.
    linear: LinearLayer,
    inputs: usize,
    outputs: usize,
}

/// The offsets and masks of a map: [`OFFSET_NUMBERS_PER_POSITION`] numbers for each position.
pub(crate) struct TapOffsets {
    numbers: Vec<f32>,
    height: usize,
    width: usize,
}

/// The four positions around a tap, with their weights. Positions outside of the map have the weight 0.
type TapCorners = [(usize, f32); 4];

impl FeatureMap {
    pub(crate) fn position_count(&self) -> usize {
        self.height * self.width
    }

    /// Height and width after a convolution with this stride.
    fn size_after(&self, stride: usize) -> (usize, usize) {
        (self.height.div_ceil(stride), self.width.div_ceil(stride))
    }
}

impl TapOffsets {
    /// Reads offsets and masks from a map of [`OFFSET_NUMBERS_PER_POSITION`] channels. A sigmoid brings the masks
    /// between 0 and 1.
    pub(crate) fn new(map: &FeatureMap) -> Result<Self> {
        let mut numbers = map.x.to_dtype(candle_core::DType::F32)?.flatten_all()?.to_vec1::<f32>()?;
        for masks in numbers.chunks_exact_mut(OFFSET_NUMBERS_PER_POSITION).map(|row| &mut row[2 * KERNEL_TAPS..]) {
            masks.iter_mut().for_each(|mask| *mask = 1.0 / (1.0 + (-*mask).exp()));
        }
        Ok(Self { numbers, height: map.height, width: map.width })
    }

    /// The offsets (down, across) and the mask of a tap at a position of an output map of this size.
    ///
    /// GLIP's head uses the offsets of one level for a map of another size. Its original code then indexed the memory
    /// of the offsets, channel by channel, with the size of the other map, and the published weights were trained in
    /// this way. So the same wrong numbers must be read here.
    fn tap_offset(&self, size: (usize, usize), position: usize, tap: usize) -> (f32, f32, f32) {
        let count = self.height * self.width;
        if size == (self.height, self.width) {
            let row =
                &self.numbers[position * OFFSET_NUMBERS_PER_POSITION..(position + 1) * OFFSET_NUMBERS_PER_POSITION];
            return (row[2 * tap], row[2 * tap + 1], row[2 * KERNEL_TAPS + tap]);
        }
        let number = |first: usize, channel: usize| {
            let at = channel * size.0 * size.1 + position;
            self.numbers.get(at % count * OFFSET_NUMBERS_PER_POSITION + first + at / count).copied().unwrap_or_default()
        };
        (number(0, 2 * tap), number(0, 2 * tap + 1), number(2 * KERNEL_TAPS, tap))
    }
}

impl Conv3Layer {
    /// Reads a convolution: `weight` [outputs, inputs, 3, 3] and `bias`.
    pub(crate) fn from_weights(
        weights: &WeightScope<'_>,
        inputs: usize,
        outputs: usize,
    ) -> std::result::Result<Self, LocalError> {
        let kernel = weights.read_tensor("weight", &[outputs, inputs, 3, 3])?;
        let bias = weights.read_tensor("bias", &[outputs])?;
        let rows = kernel.permute((0, 2, 3, 1)).and_then(|kernel| kernel.contiguous()?.flatten_from(1));
        let linear = rows.and_then(|rows| LinearLayer::new(&rows, Some(bias)));
        Ok(Self { linear: linear.map_err(|error| weights.tensor_error("weight", &error))?, inputs, outputs })
    }

    /// The plain convolution. Each tap reads one position, so only the first of its four corners is used.
    pub(crate) fn convolve_plain(&self, map: &FeatureMap, stride: usize) -> Result<FeatureMap> {
        let (height, width) = map.size_after(stride);
        let corners = |position: usize, tap: usize| {
            let (y, x) = tap_place(position, tap, width, stride);
            let inside = (0..map.height as isize).contains(&y) && (0..map.width as isize).contains(&x);
            let row = if inside { y as usize * map.width + x as usize } else { 0 };
            [(row, f32::from(u8::from(inside))), (0, 0.0), (0, 0.0), (0, 0.0)]
        };
        self.convolve_gathered(map, (height, width), 1, corners)
    }

    /// The modulated deformable convolution: each tap is moved by an offset, read between four positions, and weighted
    /// by a mask.
    pub(crate) fn convolve_deformed(&self, map: &FeatureMap, stride: usize, bends: &TapOffsets) -> Result<FeatureMap> {
        let size = map.size_after(stride);
        let corners = |position: usize, tap: usize| {
            let (y, x) = tap_place(position, tap, size.1, stride);
            let (down, across, mask) = bends.tap_offset(size, position, tap);
            corners_around(y as f32 + down, x as f32 + across, mask, map)
        };
        self.convolve_gathered(map, size, 4, corners)
    }

    /// Mixes the corners of each tap of each position, and multiplies the taps with the kernel. Only the first `used`
    /// corners count.
    fn convolve_gathered(
        &self,
        map: &FeatureMap,
        (height, width): (usize, usize),
        used: usize,
        corners: impl Fn(usize, usize) -> TapCorners + Sync,
    ) -> Result<FeatureMap> {
        let count = height * width;
        if !is_cpu_f32(&map.x) {
            let x = self.linear.apply_to(&gather_taps_on_device(map, count, used, corners)?)?;
            return Ok(FeatureMap { x, height, width });
        }
        let (inputs, taps_length) = (self.inputs, KERNEL_TAPS * self.inputs);
        let mut y = vec![0.0; count * self.outputs];
        with_f32_slice(&map.x, |x| {
            each_tile(&mut y, self.outputs, |from, y, memory| {
                let [taps] = split_memory(memory, [y.len() / self.outputs * taps_length]);
                for (at, taps) in taps.chunks_exact_mut(taps_length).enumerate() {
                    for (tap, into) in taps.chunks_exact_mut(inputs).enumerate() {
                        mix_rows(x, inputs, &corners(from + at, tap)[..used], into);
                    }
                }
                self.linear.write_rows(taps, y)
            })
        })?;
        let x = Tensor::from_vec(y, (count, self.outputs), map.x.device())?;
        Ok(FeatureMap { x, height, width })
    }
}

/// The row and column that a tap reads without an offset.
fn tap_place(position: usize, tap: usize, width: usize, stride: usize) -> (isize, isize) {
    let at = |along: usize, tap: usize| (along * stride + tap).cast_signed() - 1;
    (at(position / width, tap / 3), at(position % width, tap % 3))
}

/// The four positions around a point, with their weights for bilinear interpolation times `mask`.
fn corners_around(y: f32, x: f32, mask: f32, map: &FeatureMap) -> TapCorners {
    // A point far outside gives 0 as one just outside does. Clamping prevents an overflow of the indices.
    let (y, x) = (y.clamp(-2.0, map.height as f32 + 1.0), x.clamp(-2.0, map.width as f32 + 1.0));
    let (top, left) = (y.floor(), x.floor());
    let (down, across) = (y - top, x - left);
    let corner = |row: isize, column: isize, share: f32| {
        let inside = (0..map.height as isize).contains(&row) && (0..map.width as isize).contains(&column);
        if inside { (row as usize * map.width + column as usize, share * mask) } else { (0, 0.0) }
    };
    let (top, left) = (top as isize, left as isize);
    [
        corner(top, left, (1.0 - down) * (1.0 - across)),
        corner(top, left + 1, (1.0 - down) * across),
        corner(top + 1, left, down * (1.0 - across)),
        corner(top + 1, left + 1, down * across),
    ]
}

/// Writes the weighted sum of rows of x, of `width` numbers each: of four rows, or of one with the weight 1 or 0.
pub(crate) fn mix_rows(x: &[f32], width: usize, corners: &[(usize, f32)], into: &mut [f32]) {
    let row = |at: usize| &x[corners[at].0 * width..(corners[at].0 + 1) * width];
    match corners {
        [(_, share)] if *share == 1.0 => into.copy_from_slice(row(0)),
        [a, b, c, d] => {
            let rows = row(0).iter().zip(row(1)).zip(row(2).iter().zip(row(3)));
            for (into, ((w, x), (y, z))) in into.iter_mut().zip(rows) {
                *into = a.1 * w + b.1 * x + c.1 * y + d.1 * z;
            }
        }
        _ => into.fill(0.0),
    }
}

/// The taps of each position side by side, [positions, taps * channels], with candle's operators.
fn gather_taps_on_device(
    map: &FeatureMap,
    count: usize,
    used: usize,
    corners: impl Fn(usize, usize) -> TapCorners,
) -> Result<Tensor> {
    let device = map.x.device();
    let tap = |tap: usize| {
        let all: Vec<TapCorners> = (0..count).map(|position| corners(position, tap)).collect();
        mix_rows_on_device(&map.x, &all, used, device)
    };
    Tensor::cat(&(0..KERNEL_TAPS).map(tap).collect::<Result<Vec<_>>>()?, 1)
}

/// The weighted sum of four rows of x for each point, with candle's operators.
pub(crate) fn mix_rows_on_device(
    x: &Tensor,
    points: &[[(usize, f32); 4]],
    used: usize,
    device: &candle_core::Device,
) -> Result<Tensor> {
    let mut sum: Option<Tensor> = None;
    for corner in 0..used {
        let rows = Tensor::from_vec(points.iter().map(|point| point[corner].0 as u32).collect(), points.len(), device)?;
        let shares = Tensor::from_vec(points.iter().map(|point| point[corner].1).collect(), (points.len(), 1), device)?;
        let part = x.index_select(&rows, 0)?.broadcast_mul(&shares.to_dtype(x.dtype())?)?;
        sum = Some(match sum {
            None => part,
            Some(sum) => (sum + part)?,
        });
    }
    sum.map_or_else(|| candle_core::bail!("no corner is used"), Ok)
}

#[cfg(test)]
mod tests;

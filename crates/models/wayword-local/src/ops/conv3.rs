//! Convolutions of 3 x 3 over channels-last maps, plain and deformed.
//!
//! On the CPU, tiles of positions are gathered, nine rows of channels for each, and multiplied while they are in the
//! cache. On any other device it is gathers and a product of candle's.

use super::{
    Linear,
    kernels::{is_ours, with_numbers},
    tiles::{each_tile, room},
};
use crate::{LocalError, weights::Scope};
use candle_core::{Result, Tensor};

/// Taps of a kernel, row by row.
const TAPS: usize = 9;

/// Numbers that a deformed convolution needs for each position: two offsets (down, across) a tap, then the masks.
pub(crate) const BENDS: usize = 3 * TAPS;

/// A map of features: [height * width, channels], rows from the top.
#[derive(Clone)]
pub(crate) struct Map {
    pub(crate) x: Tensor,
    pub(crate) height: usize,
    pub(crate) width: usize,
}

/// A convolution of 3 x 3 with a padding of 1.
pub(crate) struct Conv3 {
    linear: Linear,
    inputs: usize,
    outputs: usize,
}

/// The offsets and masks of a map: [`BENDS`] numbers for each position.
pub(crate) struct Bends {
    numbers: Vec<f32>,
    height: usize,
    width: usize,
}

/// Where a tap reads: rows of the map and their shares. What lies outside has a share of 0.
type Corners = [(usize, f32); 4];

impl Map {
    pub(crate) fn count(&self) -> usize {
        self.height * self.width
    }

    /// Its size after a convolution with this stride.
    fn after(&self, stride: usize) -> (usize, usize) {
        (self.height.div_ceil(stride), self.width.div_ceil(stride))
    }
}

impl Bends {
    /// From a map of [`BENDS`] channels, whose masks are not yet between 0 and 1.
    pub(crate) fn new(map: &Map) -> Result<Self> {
        let mut numbers = map.x.to_dtype(candle_core::DType::F32)?.flatten_all()?.to_vec1::<f32>()?;
        for masks in numbers.chunks_exact_mut(BENDS).map(|row| &mut row[2 * TAPS..]) {
            masks.iter_mut().for_each(|mask| *mask = 1.0 / (1.0 + (-*mask).exp()));
        }
        Ok(Self { numbers, height: map.height, width: map.width })
    }

    /// The offsets (down, across) and the mask of a tap at a position of a map of another size or the same.
    ///
    /// The published weights were trained with offsets of the wrong size in one place, which were read as memory is:
    /// channel by channel, with the other map's size. So a map of another size must be read in that way here.
    fn at(&self, size: (usize, usize), position: usize, tap: usize) -> (f32, f32, f32) {
        let count = self.height * self.width;
        if size == (self.height, self.width) {
            let row = &self.numbers[position * BENDS..(position + 1) * BENDS];
            return (row[2 * tap], row[2 * tap + 1], row[2 * TAPS + tap]);
        }
        let number = |first: usize, channel: usize| {
            let at = channel * size.0 * size.1 + position;
            self.numbers.get(at % count * BENDS + first + at / count).copied().unwrap_or_default()
        };
        (number(0, 2 * tap), number(0, 2 * tap + 1), number(2 * TAPS, tap))
    }
}

impl Conv3 {
    /// A convolution from a checkpoint's `weight` [outputs, inputs, 3, 3] and `bias`.
    pub(crate) fn load(weights: &Scope<'_>, inputs: usize, outputs: usize) -> std::result::Result<Self, LocalError> {
        let kernel = weights.tensor("weight", &[outputs, inputs, 3, 3])?;
        let bias = weights.tensor("bias", &[outputs])?;
        let rows = kernel.permute((0, 2, 3, 1)).and_then(|kernel| kernel.contiguous()?.flatten_from(1));
        let linear = rows.and_then(|rows| Linear::new(&rows, Some(bias)));
        Ok(Self { linear: linear.map_err(|error| weights.wrong("weight", &error))?, inputs, outputs })
    }

    /// The plain convolution.
    pub(crate) fn plain(&self, map: &Map, stride: usize) -> Result<Map> {
        let (height, width) = map.after(stride);
        let corners = |position: usize, tap: usize| {
            let (y, x) = place(position, tap, width, stride);
            let inside = (0..map.height as isize).contains(&y) && (0..map.width as isize).contains(&x);
            let row = if inside { y as usize * map.width + x as usize } else { 0 };
            [(row, f32::from(u8::from(inside))), (0, 0.0), (0, 0.0), (0, 0.0)]
        };
        self.gathered(map, (height, width), 1, corners)
    }

    /// The modulated deformable convolution: each tap is moved by an offset, read between four positions, and weighted by
    /// a mask.
    pub(crate) fn deformed(&self, map: &Map, stride: usize, bends: &Bends) -> Result<Map> {
        let size = map.after(stride);
        let corners = |position: usize, tap: usize| {
            let (y, x) = place(position, tap, size.1, stride);
            let (down, across, mask) = bends.at(size, position, tap);
            between(y as f32 + down, x as f32 + across, mask, map)
        };
        self.gathered(map, size, 4, corners)
    }

    /// The product of the kernel with what is read for each tap of each position; the first `used` corners count.
    fn gathered(
        &self,
        map: &Map,
        (height, width): (usize, usize),
        used: usize,
        corners: impl Fn(usize, usize) -> Corners + Sync,
    ) -> Result<Map> {
        let count = height * width;
        if !is_ours(&map.x) {
            let x = self.linear.of(&on_device(map, count, used, corners)?)?;
            return Ok(Map { x, height, width });
        }
        let (inputs, row) = (self.inputs, TAPS * self.inputs);
        let mut y = vec![0.0; count * self.outputs];
        with_numbers(&map.x, |x| {
            each_tile(&mut y, self.outputs, |from, y, memory| {
                let [taps] = room(memory, [y.len() / self.outputs * row]);
                for (at, taps) in taps.chunks_exact_mut(row).enumerate() {
                    for (tap, into) in taps.chunks_exact_mut(inputs).enumerate() {
                        mix(x, inputs, &corners(from + at, tap)[..used], into);
                    }
                }
                self.linear.rows(taps, y)
            })
        })?;
        let x = Tensor::from_vec(y, (count, self.outputs), map.x.device())?;
        Ok(Map { x, height, width })
    }
}

/// The row and column that a tap reads without an offset.
fn place(position: usize, tap: usize, width: usize, stride: usize) -> (isize, isize) {
    let at = |along: usize, tap: usize| (along * stride + tap).cast_signed() - 1;
    (at(position / width, tap / 3), at(position % width, tap % 3))
}

/// The four positions around a point, with their shares.
fn between(y: f32, x: f32, mask: f32, map: &Map) -> Corners {
    // Far outside is as good as just outside, and cannot overflow.
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

/// Writes the sum of rows of x with their shares.
pub(crate) fn mix(x: &[f32], width: usize, corners: &[(usize, f32)], into: &mut [f32]) {
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

/// What is read for each tap of each position, [positions, taps * channels], by candle's operators.
fn on_device(map: &Map, count: usize, used: usize, corners: impl Fn(usize, usize) -> Corners) -> Result<Tensor> {
    let device = map.x.device();
    let tap = |tap: usize| {
        let all: Vec<Corners> = (0..count).map(|position| corners(position, tap)).collect();
        rows_between(&map.x, &all, used, device)
    };
    Tensor::cat(&(0..TAPS).map(tap).collect::<Result<Vec<_>>>()?, 1)
}

/// The sum of four rows of x with their shares, for each of many points, by candle's operators.
pub(crate) fn rows_between(
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
mod tests {
    use super::*;
    use candle_core::Device;

    fn drawn(shape: &[usize], seed: u64) -> Tensor {
        let draw = |at: u64| (wayword_core::seed::derive(seed + at, &["conv"]) >> 40) as f32 / (1 << 23) as f32 - 1.0;
        let count = shape.iter().product::<usize>() as u64;
        Tensor::from_vec((0..count).map(draw).collect(), shape, &Device::Cpu).unwrap()
    }

    fn conv() -> (Conv3, Tensor, Tensor) {
        let (kernel, bias) = (drawn(&[5, 4, 3, 3], 1), drawn(&[5], 2));
        let rows = kernel.permute((0, 2, 3, 1)).unwrap().contiguous().unwrap().flatten_from(1).unwrap();
        let linear = Linear::new(&rows, Some(bias.clone())).unwrap();
        (Conv3 { linear, inputs: 4, outputs: 5 }, kernel, bias)
    }

    fn off(a: &Tensor, b: &Tensor) -> f32 {
        assert_eq!(a.dims(), b.dims());
        (a - b).unwrap().abs().unwrap().max_all().unwrap().to_scalar().unwrap()
    }

    #[test]
    fn a_plain_convolution_is_candles() {
        let (conv, kernel, bias) = conv();
        for (height, width, stride) in [(13, 9, 1), (13, 9, 2), (12, 8, 2), (1, 1, 2), (1, 2, 1)] {
            let x = drawn(&[height * width, 4], 3);
            let ours = conv.plain(&Map { x: x.clone(), height, width }, stride).unwrap();
            let image = x.t().unwrap().contiguous().unwrap().reshape((1, 4, height, width)).unwrap();
            let theirs = image.conv2d(&kernel, 1, stride, 1, 1).unwrap();
            let theirs = theirs.flatten_from(2).unwrap().squeeze(0).unwrap().t().unwrap();
            assert!(off(&ours.x, &theirs.broadcast_add(&bias).unwrap()) < 1e-5);
        }
    }

    #[test]
    fn offsets_of_whole_positions_are_a_moved_map() {
        let (conv, ..) = conv();
        let (height, width) = (7, 6);
        let x = drawn(&[42, 4], 5);
        // Everything is read one row further down, and what is below the map is 0. A mask of 40 is 1.
        let bends: Vec<f32> =
            (0..42 * BENDS).map(|at| [1.0, 0.0, 40.0][if at % BENDS < 18 { at % BENDS % 2 } else { 2 }]).collect();
        let bends = Tensor::from_vec(bends, (42, BENDS), &Device::Cpu).unwrap();
        let bends = Bends::new(&Map { x: bends, height, width }).unwrap();
        let ours = conv.deformed(&Map { x: x.clone(), height, width }, 1, &bends).unwrap();
        let moved = x.narrow(0, width, 36).unwrap().pad_with_zeros(0, 0, width).unwrap();
        let plain = conv.plain(&Map { x: moved, height, width }, 1).unwrap();
        // In the first row the plain convolution of the moved map lacks the row that left it.
        let rest = |map: &Map| map.x.narrow(0, width, 36).unwrap();
        assert!(off(&rest(&ours), &rest(&plain)) < 1e-5);
    }

    #[test]
    fn on_any_other_device_it_would_be_the_same() {
        let (conv, ..) = conv();
        let (height, width) = (9, 7);
        let map = Map { x: drawn(&[63, 4], 7), height, width };
        for (stride, shape) in [(1, (9, 7)), (2, (5, 4)), (1, (18, 14))] {
            let bends = (drawn(&[shape.0 * shape.1, BENDS], 9) * 3.0).unwrap();
            let bends = Bends::new(&Map { x: bends, height: shape.0, width: shape.1 }).unwrap();
            let ours = conv.deformed(&map, stride, &bends).unwrap();
            let size = map.after(stride);
            let corners = |position: usize, tap: usize| {
                let (y, x) = place(position, tap, size.1, stride);
                let (down, across, mask) = bends.at(size, position, tap);
                between(y as f32 + down, x as f32 + across, mask, &map)
            };
            let theirs = conv.linear.of(&on_device(&map, size.0 * size.1, 4, corners).unwrap()).unwrap();
            assert!(off(&ours.x, &theirs) < 1e-5);
        }
    }

    #[test]
    fn offsets_of_another_size_are_read_as_memory() {
        // Each number is its place in memory: channel by channel, 18 channels of 2 x 3, then 9 of masks.
        let memory = |position: usize, channel: usize| match channel {
            0..18 => (channel * 6 + position) as f32,
            _ => ((channel - 18) * 6 + position) as f32 / 1000.0,
        };
        let numbers = (0..6 * BENDS).map(|at| memory(at / BENDS, at % BENDS)).collect();
        let bends = Bends { numbers, height: 2, width: 3 };
        for (position, tap) in [(0, 0), (1, 4), (0, 8)] {
            let (down, across, mask) = bends.at((1, 2), position, tap);
            assert_eq!(down, (2 * tap * 2 + position) as f32);
            assert_eq!(across, ((2 * tap + 1) * 2 + position) as f32);
            assert_eq!(mask, (tap * 2 + position) as f32 / 1000.0);
        }
    }

    #[test]
    fn offsets_far_away_or_without_a_value_do_no_harm() {
        let (conv, ..) = conv();
        let map = Map { x: drawn(&[6, 4], 7), height: 2, width: 3 };
        for number in [1e30, -1e30, f32::INFINITY, f32::NAN] {
            let bends = Tensor::full(number, (6, BENDS), &Device::Cpu).unwrap();
            let bends = Bends::new(&Map { x: bends, height: 2, width: 3 }).unwrap();
            assert_eq!(conv.deformed(&map, 1, &bends).unwrap().x.dims(), [6, 5]);
        }
    }
}

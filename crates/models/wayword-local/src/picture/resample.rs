//! Resizes pictures exactly as Pillow does, bit by bit.
//!
//! Fast libraries keep a filter's weights in 16 bits. Some percent of their pixels differ from Pillow's by one, and
//! this changes the second digit of a model's outputs. Pillow's method is short: the weights have 22 bits, the rows are
//! resized first, then the columns, and the numbers in between have 8 bits. (`Resample.c` of Pillow 12:
//! `precompute_coeffs`, `normalize_coeffs_8bpc`, `ImagingResampleInner`. Pillow 13 resizes the columns of some pictures
//! first, so it rounds differently; the public checkpoints were made with earlier versions.)

use rayon::prelude::*;
use std::ops::Range;

/// The number of fraction bits of a weight.
const WEIGHT_FRACTION_BITS: u32 = 32 - 8 - 2;

/// The rule by which new pixels are interpolated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ResampleFilter {
    /// From the two nearest pixels.
    Bilinear,
    /// From the four nearest pixels, with a = -0.5.
    Bicubic,
}

/// The weights for resizing one axis of a picture.
pub(crate) struct ResampleAxis {
    /// The number of old pixels.
    from: usize,
    /// The number of new pixels, with black ones.
    to: usize,
    /// The position of the first computed pixel. Everything before the first and after the last one is black.
    first: usize,
    /// One window for each computed pixel.
    windows: Vec<ResampleWindow>,
}

/// The old pixels and their weights for one new pixel.
struct ResampleWindow {
    /// The first old pixel.
    start: usize,
    /// The weights of the old pixels, in units of 2 to the power of -[`WEIGHT_FRACTION_BITS`].
    weights: Vec<i32>,
}

impl ResampleFilter {
    /// The largest distance of an old pixel that counts, pixels of the coarser picture.
    fn reach_px(self) -> f64 {
        match self {
            Self::Bilinear => 1.0,
            Self::Bicubic => 2.0,
        }
    }

    /// The weight of an old pixel at a distance from the new one.
    fn weight_at(self, at: f64) -> f64 {
        const BICUBIC_A: f64 = -0.5;
        let at = at.abs();
        match self {
            Self::Bilinear if at < 1.0 => 1.0 - at,
            Self::Bicubic if at < 1.0 => ((BICUBIC_A + 2.0) * at - (BICUBIC_A + 3.0)) * at * at + 1.0,
            Self::Bicubic if at < 2.0 => (((at - 5.0) * at + 8.0) * at - 4.0) * BICUBIC_A,
            _ => 0.0,
        }
    }

    /// The window of new pixel `at` on an axis that is resized from `from` to `to` pixels.
    fn pixel_window(self, at: usize, from: usize, to: usize) -> ResampleWindow {
        if from == to {
            return ResampleWindow { start: at, weights: vec![1 << WEIGHT_FRACTION_BITS] };
        }
        let scale = from as f64 / to as f64;
        let stretch = scale.max(1.0);
        let reach = self.reach_px() * stretch;
        let centre = (at as f64 + 0.5) * scale;
        let start = (centre - reach + 0.5).max(0.0) as usize;
        let end = ((centre + reach + 0.5) as usize).min(from);
        let shares: Vec<f64> =
            (start..end).map(|pixel| self.weight_at((pixel as f64 - centre + 0.5) * (1.0 / stretch))).collect();
        let sum: f64 = shares.iter().sum();
        let to_fixed_point = |share: &f64| {
            let share = if sum == 0.0 { *share } else { share / sum } * f64::from(1 << WEIGHT_FRACTION_BITS);
            (if share < 0.0 { share - 0.5 } else { share + 0.5 }) as i32
        };
        ResampleWindow { start, weights: shares.iter().map(to_fixed_point).collect() }
    }
}

impl ResampleAxis {
    /// Resizes an axis from `from` pixels to `to`, and keeps the `keep` pixels in the middle. If there are fewer, black
    /// is added around them (transformers' `center_crop`). Only kept pixels are computed.
    pub(crate) fn keep_middle(filter: ResampleFilter, from: usize, to: usize, keep: usize) -> Self {
        let (kept, first): (Range<usize>, usize) = if to >= keep {
            let left = (to - keep) / 2;
            (left..left + keep, 0)
        } else {
            (0..to, (keep - to).div_ceil(2))
        };
        Self { from, to: keep, first, windows: kept.map(|at| filter.pixel_window(at, from, to)).collect() }
    }

    /// The range of old pixels that have a weight.
    fn source_range(&self) -> Range<usize> {
        let start = self.windows.first().map_or(0, |window| window.start);
        let end = self.windows.iter().map(|window| window.start + window.weights.len()).max().unwrap_or(0);
        start..end.max(start)
    }
}

/// Resizes a picture of 3 bytes per pixel, rows from the top.
pub(crate) fn resample_picture(rgb: &[u8], down: &ResampleAxis, across: &ResampleAxis) -> Vec<u8> {
    let source_rows = down.source_range();
    let row = across.windows.len() * 3;
    let mut narrow = vec![0; source_rows.len() * row];
    let rows = rgb.chunks(across.from * 3).skip(source_rows.start).take(source_rows.len()).collect::<Vec<_>>();
    narrow.par_chunks_mut(row.max(1)).zip(rows).for_each(|(to, from)| resample_row(from, to, across));
    let mut resized = vec![0; down.to * across.to * 3];
    let rows = resized.par_chunks_mut(across.to * 3).skip(down.first).zip(&down.windows);
    rows.for_each(|(to, window)| {
        let from = (window.start - source_rows.start) * row;
        let to = &mut to[across.first * 3..][..row];
        mix_source_rows(&narrow[from..from + window.weights.len() * row], to, window);
    });
    resized
}

/// Resizes one row of pixels.
fn resample_row(from: &[u8], to: &mut [u8], across: &ResampleAxis) {
    for (pixel, window) in to.chunks_exact_mut(3).zip(&across.windows) {
        let mut sums = [1 << (WEIGHT_FRACTION_BITS - 1); 3];
        for (pixel, &weight) in from[window.start * 3..].chunks_exact(3).zip(&window.weights) {
            for (sum, &byte) in sums.iter_mut().zip(pixel) {
                *sum += i32::from(byte) * weight;
            }
        }
        for (byte, sum) in pixel.iter_mut().zip(sums) {
            *byte = clip_to_byte(sum);
        }
    }
}

/// Mixes the rows of a window to one new row.
fn mix_source_rows(from: &[u8], to: &mut [u8], window: &ResampleWindow) {
    let mut sums = vec![1 << (WEIGHT_FRACTION_BITS - 1); to.len()];
    for (row, &weight) in from.chunks_exact(to.len().max(1)).zip(&window.weights) {
        for (sum, &byte) in sums.iter_mut().zip(row) {
            *sum += i32::from(byte) * weight;
        }
    }
    for (byte, sum) in to.iter_mut().zip(sums) {
        *byte = clip_to_byte(sum);
    }
}

/// The byte for a sum of bytes times weights. The sums begin with half a unit, so that this rounds.
fn clip_to_byte(sum: i32) -> u8 {
    (sum >> WEIGHT_FRACTION_BITS).clamp(0, 255) as u8
}

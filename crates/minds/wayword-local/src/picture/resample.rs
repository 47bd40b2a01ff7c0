//! Resizing pictures bit by bit as Pillow does.
//!
//! The fast libraries keep a filter's weights in 16 bits and differ from Pillow by one in a few of a hundred pixels, which a
//! model sees in its second digit. Pillow's way is short: weights of 22 bits, first across, then down, 8 bits between.
//! (`Resample.c` of Pillow 12: `precompute_coeffs`, `normalize_coeffs_8bpc`, `ImagingResampleInner`. Pillow 13 takes some
//! pictures down first, which rounds otherwise; the public checkpoints were made with what came before.)

use rayon::prelude::*;
use std::ops::Range;

/// Bits behind the point of a weight.
const BITS: u32 = 32 - 8 - 2;

/// How pixels between pixels are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Filter {
    /// Of the two nearest.
    Bilinear,
    /// Of the four nearest, with a = -0.5.
    Bicubic,
}

/// What becomes of one axis of a picture.
pub(super) struct Axis {
    /// Pixels that it had.
    from: usize,
    /// Pixels that it has in the end.
    to: usize,
    /// Where the first made pixel stands: what is before the first and behind the last is black.
    first: usize,
    /// One for each pixel that is made.
    windows: Vec<Window>,
}

/// Which pixels make a new one.
struct Window {
    start: usize,
    weights: Vec<i32>,
}

impl Filter {
    /// How far it reaches, pixels.
    fn reach(self) -> f64 {
        match self {
            Self::Bilinear => 1.0,
            Self::Bicubic => 2.0,
        }
    }

    fn weight(self, at: f64) -> f64 {
        const A: f64 = -0.5;
        let at = at.abs();
        match self {
            Self::Bilinear if at < 1.0 => 1.0 - at,
            Self::Bicubic if at < 1.0 => ((A + 2.0) * at - (A + 3.0)) * at * at + 1.0,
            Self::Bicubic if at < 2.0 => (((at - 5.0) * at + 8.0) * at - 4.0) * A,
            _ => 0.0,
        }
    }

    /// What makes pixel `at` of an axis that goes from `from` to `to` pixels.
    fn window(self, at: usize, from: usize, to: usize) -> Window {
        if from == to {
            return Window { start: at, weights: vec![1 << BITS] };
        }
        let scale = from as f64 / to as f64;
        let stretch = scale.max(1.0);
        let reach = self.reach() * stretch;
        let centre = (at as f64 + 0.5) * scale;
        let start = (centre - reach + 0.5).max(0.0) as usize;
        let end = ((centre + reach + 0.5) as usize).min(from);
        let shares: Vec<f64> =
            (start..end).map(|pixel| self.weight((pixel as f64 - centre + 0.5) * (1.0 / stretch))).collect();
        let sum: f64 = shares.iter().sum();
        let whole = |share: &f64| {
            let share = if sum == 0.0 { *share } else { share / sum } * f64::from(1 << BITS);
            (if share < 0.0 { share - 0.5 } else { share + 0.5 }) as i32
        };
        Window { start, weights: shares.iter().map(whole).collect() }
    }
}

impl Axis {
    /// From `from` pixels to `to`, of which the middle `keep` are kept; where they are fewer, there is black around them
    /// (transformers' `center_crop`). Only what is kept is ever computed.
    pub(super) fn middle(filter: Filter, from: usize, to: usize, keep: usize) -> Self {
        let (kept, first): (Range<usize>, usize) = if to >= keep {
            let left = (to - keep) / 2;
            (left..left + keep, 0)
        } else {
            (0..to, (keep - to).div_ceil(2))
        };
        Self { from, to: keep, first, windows: kept.map(|at| filter.window(at, from, to)).collect() }
    }

    /// The pixels that are looked at.
    fn seen(&self) -> Range<usize> {
        let start = self.windows.first().map_or(0, |window| window.start);
        let end = self.windows.iter().map(|window| window.start + window.weights.len()).max().unwrap_or(0);
        start..end.max(start)
    }
}

/// A picture of 3 bytes a pixel, rows from the top, resized.
pub(super) fn resample(rgb: &[u8], down: &Axis, across: &Axis) -> Vec<u8> {
    let seen = down.seen();
    let row = across.windows.len() * 3;
    let mut narrow = vec![0; seen.len() * row];
    let rows = rgb.chunks(across.from * 3).skip(seen.start).take(seen.len()).collect::<Vec<_>>();
    narrow.par_chunks_mut(row.max(1)).zip(rows).for_each(|(to, from)| across_row(from, to, across));
    let mut made = vec![0; down.to * across.to * 3];
    let rows = made.par_chunks_mut(across.to * 3).skip(down.first).zip(&down.windows);
    rows.for_each(|(to, window)| {
        let from = (window.start - seen.start) * row;
        let to = &mut to[across.first * 3..][..row];
        down_row(&narrow[from..from + window.weights.len() * row], to, window);
    });
    made
}

fn across_row(from: &[u8], to: &mut [u8], across: &Axis) {
    for (pixel, window) in to.chunks_exact_mut(3).zip(&across.windows) {
        let mut sums = [1 << (BITS - 1); 3];
        for (pixel, &weight) in from[window.start * 3..].chunks_exact(3).zip(&window.weights) {
            for (sum, &byte) in sums.iter_mut().zip(pixel) {
                *sum += i32::from(byte) * weight;
            }
        }
        for (byte, sum) in pixel.iter_mut().zip(sums) {
            *byte = clipped(sum);
        }
    }
}

fn down_row(from: &[u8], to: &mut [u8], window: &Window) {
    let mut sums = vec![1 << (BITS - 1); to.len()];
    for (row, &weight) in from.chunks_exact(to.len().max(1)).zip(&window.weights) {
        for (sum, &byte) in sums.iter_mut().zip(row) {
            *sum += i32::from(byte) * weight;
        }
    }
    for (byte, sum) in to.iter_mut().zip(sums) {
        *byte = clipped(sum);
    }
}

fn clipped(sum: i32) -> u8 {
    (sum >> BITS).clamp(0, 255) as u8
}

//! Means over a map for each channel. The norms, the weights of levels, and the activation depend on them.

use crate::ops::{
    conv3::FeatureMap,
    kernels::{is_cpu_f32, with_f32_slice},
    tiles::TILE_ROWS,
};
use candle_core::{Result, Tensor};
use rayon::prelude::*;

/// Means over the positions of a map, for each channel.
pub(super) struct ChannelMeans {
    /// The means of the numbers.
    pub(super) plain: Vec<f64>,
    /// The means of the squares of the numbers.
    pub(super) square: Vec<f64>,
    /// The means with the given weight for each position.
    pub(super) shared: Vec<f64>,
}

impl ChannelMeans {
    /// The means of a map. `shares` are the weights of its positions; without them all positions count the same.
    pub(super) fn from_map(map: &FeatureMap, shares: Option<&[f32]>) -> Result<Self> {
        let (count, width) = map.x.dims2()?;
        if !is_cpu_f32(&map.x) {
            let x = map.x.to_dtype(candle_core::DType::F32)?;
            let numbers =
                |x: Tensor| -> Result<Vec<f64>> { Ok(x.to_vec1::<f32>()?.into_iter().map(f64::from).collect()) };
            let plain = numbers(x.mean(0)?)?;
            let shared = match shares {
                None => plain.clone(),
                Some(shares) => {
                    let shares = Tensor::from_slice(shares, (1, count), x.device())?;
                    numbers(shares.matmul(&x)?.squeeze(0)?)?
                }
            };
            return Ok(Self { plain, square: numbers(x.sqr()?.mean(0)?)?, shared });
        }
        with_f32_slice(&map.x, |x| {
            let tiles =
                x.par_chunks(width * TILE_ROWS).enumerate().map(|(tile, x)| Self::sum_tile(tile, x, width, shares));
            let zero = || vec![0.0; 3 * width];
            let sums = tiles.reduce(zero, |mut a, b| {
                a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
                a
            });
            let mean = |at: usize| sums[at * width..(at + 1) * width].iter().map(|sum| sum / count as f64).collect();
            let (plain, square): (Vec<f64>, Vec<f64>) = (mean(0), mean(1));
            let shared = if shares.is_some() { sums[2 * width..].to_vec() } else { plain.clone() };
            Ok(Self { plain, square, shared })
        })
    }

    /// The sums over a tile: of the numbers, of their squares, and of the weighted numbers, for each channel.
    fn sum_tile(tile: usize, x: &[f32], width: usize, shares: Option<&[f32]>) -> Vec<f64> {
        let mut sums = vec![0.0_f32; 3 * width];
        let (plain, rest) = sums.split_at_mut(width);
        let (square, shared) = rest.split_at_mut(width);
        for (at, row) in x.chunks_exact(width).enumerate() {
            for ((plain, square), x) in plain.iter_mut().zip(&mut *square).zip(row) {
                *plain += x;
                *square += x * x;
            }
            if let Some(share) = shares.and_then(|shares| shares.get(tile * TILE_ROWS + at)) {
                shared.iter_mut().zip(row).for_each(|(shared, x)| *shared += x * share);
            }
        }
        sums.into_iter().map(f64::from).collect()
    }
}

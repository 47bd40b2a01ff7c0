//! The convolutions of a round of the head ("dynamic head", arXiv 2106.08322).
//!
//! Each level is computed from itself and from the next finer and coarser level, through deformed kernels. The three
//! results are weighted, added, and passed through an activation that depends on the whole map.
//!
//! Norms and weights multiply each channel by a number and add another one, and the activation is the larger of two
//! lines. All these numbers follow from means over the map. So a map is read only twice: for its means, and to write
//! the result.

use super::{channel_means::ChannelMeans, config::HeadConfig, enlargement::MapEnlargement, read_numbers};
use crate::{
    LocalError,
    ops::{
        conv3::{Conv3Layer, FeatureMap, OFFSET_NUMBERS_PER_POSITION, TapOffsets, mix_rows, mix_rows_on_device},
        kernels::{is_cpu_f32, with_f32_slice},
        tiles::{TILE_ROWS, each_tile, split_memory},
    },
    weights::WeightScope,
};
use candle_core::{Result, Tensor};
use rayon::prelude::*;

/// Added to the variances of groups, so that no division is by 0.
const GROUP_NORM_EPSILON: f64 = 1e-5;

/// The index of the convolution by where its input comes from: the next coarser level, the same, or the next finer one.
const CONV_FROM_COARSER: usize = 0;
const CONV_FROM_SAME: usize = 1;
const CONV_FROM_FINER: usize = 2;

/// The convolutions of one round.
pub(super) struct GlipTower {
    /// By the indices [`CONV_FROM_COARSER`], [`CONV_FROM_SAME`] and [`CONV_FROM_FINER`].
    convs: [NormedConvolution; 3],
    /// Computes the offsets and masks by which the kernels are deformed.
    offsets: Conv3Layer,
    /// The layer that computes the weight of a result from the means of its channels.
    result_weigher: (Vec<f32>, f32),
    /// The two layers that compute the activation's coefficients: rows of weights, and a bias.
    squeeze: (Vec<f32>, Vec<f32>),
    widen: (Vec<f32>, Vec<f32>),
    groups: usize,
    width: usize,
}

/// A convolution, and the norm over groups of channels that follows it.
struct NormedConvolution {
    conv: Conv3Layer,
    weight: Vec<f32>,
    bias: Vec<f32>,
}

/// The result of one convolution, with the coefficients of its norm.
struct ConvolvedLevel {
    map: FeatureMap,
    /// How the map is enlarged to the size of the level, if it comes from a coarser one.
    enlarged: Option<MapEnlargement>,
    /// For each channel: the norm's factor, the number that it adds, and the mean after the norm.
    scale: Vec<f32>,
    shift: Vec<f32>,
    mean: Vec<f32>,
}

/// The activation's coefficients for each channel: slope and height of two lines. The larger of both lines counts.
struct ActivationLines([Vec<f32>; 4]);

impl GlipTower {
    pub(super) fn from_weights(
        weights: &WeightScope<'_>,
        config: &HeadConfig,
    ) -> std::result::Result<Self, LocalError> {
        let width = config.width;
        let conv = |at: usize| {
            let part = weights.sub_scope("DyConv").sub_scope(at);
            Ok::<_, LocalError>(NormedConvolution {
                conv: Conv3Layer::from_weights(&part.sub_scope("conv"), width, width)?,
                weight: read_numbers(&part, "bn.weight", &[width])?,
                bias: read_numbers(&part, "bn.bias", &[width])?,
            })
        };
        let bias = read_numbers(weights, "AttnConv.1.bias", &[1])?;
        let relu = weights.sub_scope("relu.fc");
        let layer = |name: &str, inputs: usize, outputs: usize| {
            let part = relu.sub_scope(name);
            Ok::<_, LocalError>((
                read_numbers(&part, "weight", &[outputs, inputs])?,
                read_numbers(&part, "bias", &[outputs])?,
            ))
        };
        Ok(Self {
            convs: [conv(CONV_FROM_COARSER)?, conv(CONV_FROM_SAME)?, conv(CONV_FROM_FINER)?],
            offsets: Conv3Layer::from_weights(&weights.sub_scope("offset"), width, OFFSET_NUMBERS_PER_POSITION)?,
            result_weigher: (read_numbers(weights, "AttnConv.1.weight", &[1, width, 1, 1])?, bias[0]),
            squeeze: layer("0", width, width / 4)?,
            widen: layer("2", width / 4, 4 * width)?,
            groups: config.groups,
            width,
        })
    }

    /// Computes the next levels from levels, the finest first.
    pub(super) fn update_levels(&self, levels: &[FeatureMap]) -> Result<Vec<FeatureMap>> {
        (0..levels.len()).map(|at| self.update_level(levels, at)).collect()
    }

    /// Computes the next features of level `at`.
    fn update_level(&self, levels: &[FeatureMap], at: usize) -> Result<FeatureMap> {
        let level = &levels[at];
        let bends = TapOffsets::new(&self.offsets.convolve_plain(level, 1)?)?;
        let mut results = vec![self.convolve_map(CONV_FROM_SAME, level, 1, &bends, None)?];
        if let Some(finer) = at.checked_sub(1).and_then(|below| levels.get(below)) {
            results.push(self.convolve_map(CONV_FROM_FINER, finer, 2, &bends, None)?);
        }
        if let Some(coarser) = levels.get(at + 1) {
            results.push(self.convolve_map(CONV_FROM_COARSER, coarser, 1, &bends, Some(level))?);
        }
        // The weighted mean of the results. It is a sum of maps, each with a factor, plus one number for each channel.
        let mut height = vec![0.0; self.width];
        let mut mean = vec![0.0; self.width];
        let count = results.len() as f32;
        for result in &mut results {
            let weight = self.result_weight(&result.mean) / count;
            result.scale.iter_mut().for_each(|scale| *scale *= weight);
            height.iter_mut().zip(&result.shift).for_each(|(height, shift)| *height += shift * weight);
            mean.iter_mut().zip(&result.mean).for_each(|(sum, mean)| *sum += mean * weight);
        }
        let lines = self.activation_lines(&mean);
        let x = if is_cpu_f32(&level.x) {
            self.join_results(&results, &height, &lines, level)?
        } else {
            join_on_device(&results, &height, &lines, level)?
        };
        Ok(FeatureMap { x, ..*level })
    }

    /// Convolves a map, and computes the coefficients of the norm that follows.
    fn convolve_map(
        &self,
        which: usize,
        map: &FeatureMap,
        stride: usize,
        bends: &TapOffsets,
        like: Option<&FeatureMap>,
    ) -> Result<ConvolvedLevel> {
        let NormedConvolution { conv, weight, bias } = &self.convs[which];
        let map = conv.convolve_deformed(map, stride, bends)?;
        let enlarged = like.map(|like| MapEnlargement::new(&map, like.height, like.width));
        let shares = enlarged.as_ref().map(|enlarged| enlarged.mean_shares(&map));
        let ChannelMeans { plain, square, shared } = ChannelMeans::from_map(&map, shares.as_deref())?;
        let size = self.width / self.groups;
        let (mut scale, mut shift, mut mean) = (weight.clone(), bias.clone(), vec![0.0; self.width]);
        for group in 0..self.groups {
            let channels = group * size..(group + 1) * size;
            let group_mean = |means: &[f64]| means[channels.clone()].iter().sum::<f64>() / size as f64;
            let (centre, square) = (group_mean(&plain), group_mean(&square));
            let factor = 1.0 / ((square - centre * centre).max(0.0) + GROUP_NORM_EPSILON).sqrt();
            for channel in channels.clone() {
                scale[channel] *= factor as f32;
                shift[channel] -= (centre * f64::from(scale[channel])) as f32;
                mean[channel] = (shared[channel] * f64::from(scale[channel])) as f32 + shift[channel];
            }
        }
        Ok(ConvolvedLevel { map, enlarged, scale, shift, mean })
    }

    /// The weight of a result, from the means of its channels.
    fn result_weight(&self, mean: &[f32]) -> f32 {
        let sum: f32 = self.result_weigher.0.iter().zip(mean).map(|(weight, mean)| weight * mean).sum();
        hard_sigmoid((sum + self.result_weigher.1).max(0.0))
    }

    /// The activation's coefficients, from the means of the channels.
    fn activation_lines(&self, mean: &[f32]) -> ActivationLines {
        let layer = |(weight, bias): &(Vec<f32>, Vec<f32>), x: &[f32]| -> Vec<f32> {
            let row = |(row, bias): (&[f32], &f32)| row.iter().zip(x).map(|(a, b)| a * b).sum::<f32>() + bias;
            weight.chunks_exact(x.len()).zip(bias).map(row).collect()
        };
        let inner: Vec<f32> = layer(&self.squeeze, mean).into_iter().map(|number| number.max(0.0)).collect();
        let coefficients: Vec<f32> = layer(&self.widen, &inner).into_iter().map(|x| hard_sigmoid(x) - 0.5).collect();
        let part = |at: usize, factor: f32, added: f32| {
            coefficients[at * self.width..(at + 1) * self.width].iter().map(|number| number * factor + added).collect()
        };
        ActivationLines([part(0, 2.0, 1.0), part(1, 1.0, 0.0), part(2, 2.0, 0.0), part(3, 1.0, 0.0)])
    }

    /// The sum of the results after the activation, in one pass on the processor.
    fn join_results(
        &self,
        results: &[ConvolvedLevel],
        height: &[f32],
        lines: &ActivationLines,
        level: &FeatureMap,
    ) -> Result<Tensor> {
        let width = self.width;
        let mut y = vec![0.0; level.position_count() * width];
        for (at, result) in results.iter().enumerate() {
            with_f32_slice(&result.map.x, |x| {
                each_tile(&mut y, width, |from, y, memory| {
                    let [between] = split_memory(memory, [width]);
                    for (at_row, y) in y.chunks_exact_mut(width).enumerate() {
                        let row = match &result.enlarged {
                            None => &x[(from + at_row) * width..(from + at_row + 1) * width],
                            Some(enlarged) => {
                                mix_rows(x, width, &enlarged.corner_shares(from + at_row), between);
                                &*between
                            }
                        };
                        let each = y.iter_mut().zip(row).zip(&result.scale);
                        match at {
                            0 => each.zip(height).for_each(|(((y, x), scale), height)| *y = x * scale + height),
                            _ => each.for_each(|((y, x), scale)| *y += x * scale),
                        }
                    }
                    Ok(())
                })
            })?;
        }
        let [slope, at, other_slope, other_at] = &lines.0;
        y.par_chunks_mut(width * TILE_ROWS).flat_map_iter(|rows| rows.chunks_exact_mut(width)).for_each(|row| {
            let lines = slope.iter().zip(at).zip(other_slope.iter().zip(other_at));
            for (y, ((slope, at), (other_slope, other_at))) in row.iter_mut().zip(lines) {
                *y = (*y * slope + at).max(*y * other_slope + other_at);
            }
        });
        Tensor::from_vec(y, (level.position_count(), width), level.x.device())
    }
}

/// The sum of the results after the activation, with candle's operators.
fn join_on_device(
    results: &[ConvolvedLevel],
    height: &[f32],
    lines: &ActivationLines,
    level: &FeatureMap,
) -> Result<Tensor> {
    let (device, dtype) = (level.x.device(), level.x.dtype());
    let row = |numbers: &[f32]| Tensor::from_slice(numbers, (1, numbers.len()), device)?.to_dtype(dtype);
    let mut sum = row(height)?;
    for result in results {
        let x = match &result.enlarged {
            None => result.map.x.clone(),
            Some(enlarged) => {
                let points: Vec<_> =
                    (0..level.position_count()).map(|position| enlarged.corner_shares(position)).collect();
                mix_rows_on_device(&result.map.x, &points, 4, device)?
            }
        };
        sum = x.broadcast_mul(&row(&result.scale)?)?.broadcast_add(&sum)?;
    }
    let line = |slope: &[f32], at: &[f32]| sum.broadcast_mul(&row(slope)?)?.broadcast_add(&row(at)?);
    let [slope, at, other_slope, other_at] = &lines.0;
    line(slope, at)?.maximum(&line(other_slope, other_at)?)
}

/// A sigmoid made of straight lines: 0 up to -3, 1 from 3 on.
fn hard_sigmoid(x: f32) -> f32 {
    (x + 3.0).clamp(0.0, 6.0) / 6.0
}

//! Turns a picture into the states of its cells, which do not depend on the text. The backbone computes maps of the
//! picture at several resolutions. Each is projected to the same width, and becomes one level.

use super::{
    config::{Config, GROUPS},
    position,
};
use crate::{
    LocalError,
    ops::Linear,
    swin::{Names, Swin},
    weights::Scope,
};
use candle_core::{DType, Result, Tensor};

type Loaded<T> = std::result::Result<T, LocalError>;

/// Edge and stride, in cells, of the convolution that makes the levels that are coarser than the backbone's maps.
const KERNEL: usize = 3;
const STRIDE: usize = 2;

/// Added to the variances of groups, so that no division is by 0.
const EPSILON: f64 = 1e-5;

/// Computes the features of pictures.
pub(super) struct Eye {
    swin: Swin,
    projections: Vec<Projection>,
    /// How many maps the backbone has.
    maps: usize,
    /// A learned vector for each level, [levels, size], which is added to the positions of its cells.
    level_embed: Tensor,
    size: usize,
    temperature: f32,
}

/// The size of a level in cells. Its cells are in rows from the top.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Level {
    pub(super) height: usize,
    pub(super) width: usize,
}

/// The features of a picture, before any text.
pub(super) struct Features {
    /// The cells of all levels, the finest level first, [1, cells, size].
    pub(super) cells: Tensor,
    pub(super) levels: Vec<Level>,
}

/// A convolution and a norm over groups of channels.
struct Projection {
    layer: Linear,
    weight: Tensor,
    bias: Tensor,
    /// Whether it is a 3 x 3 convolution with a stride of 2, or a layer for single cells.
    is_coarser: bool,
}

impl Level {
    pub(super) fn cells(self) -> usize {
        self.height * self.width
    }

    /// The middles of the cells, as shares of the picture's width and height.
    pub(super) fn middles(self) -> impl Iterator<Item = [f32; 2]> {
        let share = |at: usize, of: usize| (at as f32 + 0.5) / of as f32;
        (0..self.cells()).map(move |at| [share(at % self.width, self.width), share(at / self.width, self.height)])
    }
}

impl Eye {
    pub(super) fn load(model: &Scope<'_>, config: &Config) -> Loaded<Self> {
        let backbone = &config.backbone;
        let maps = backbone.outputs.len();
        let width = |map: usize| backbone.outputs.get(map).map_or(config.size, |&stage| backbone.width_of(stage));
        let projection = |at: usize| {
            let weights = model.sub("input_proj_vision").sub(at);
            // The first coarser level is computed from the backbone's last map, each further one from the level before.
            let inputs = if at == maps { width(maps - 1) } else { width(at) };
            Projection::load(&weights, inputs, config.size, at >= maps)
        };
        Ok(Self {
            swin: Swin::load(&model.sub("backbone.conv_encoder.model"), &Names::TRANSFORMERS, backbone)?,
            projections: (0..config.levels).map(projection).collect::<Loaded<_>>()?,
            maps,
            level_embed: model.state("level_embed", &[config.levels, config.size])?,
            size: config.size,
            temperature: config.temperature,
        })
    }

    /// The features of a picture with pixels [1, 3, height, width].
    pub(super) fn of(&self, pixels: &Tensor) -> Result<Features> {
        let maps: Vec<Tensor> = self.swin.of(pixels)?.iter().map(|map| map.squeeze(0)).collect::<Result<_>>()?;
        let mut levels: Vec<Tensor> = Vec::with_capacity(self.projections.len());
        for (at, projection) in self.projections.iter().enumerate() {
            let from = if at <= self.maps { maps.get(at).or(maps.last()) } else { levels.last() };
            let Some(from) = from else { candle_core::bail!("the backbone has no maps") };
            levels.push(projection.of(from)?);
        }
        let sizes = levels.iter().map(|level| level.dims3().map(|(height, width, _)| Level { height, width }));
        let cells: Vec<Tensor> = levels.iter().map(|level| level.flatten_to(1)).collect::<Result<_>>()?;
        Ok(Features { cells: Tensor::cat(&cells, 0)?.unsqueeze(0)?, levels: sizes.collect::<Result<_>>()? })
    }

    /// The encoded positions of all cells, [1, cells, size].
    pub(super) fn positions(&self, levels: &[Level]) -> Result<Tensor> {
        let of_level = |(at, level): (usize, &Level)| {
            let sines = position::of_map(level.height, level.width, self.size, self.temperature);
            let sines = Tensor::from_vec(sines, (level.cells(), self.size), self.level_embed.device())?;
            sines.to_dtype(self.level_embed.dtype())?.broadcast_add(&self.level_embed.get(at)?)
        };
        Tensor::cat(&levels.iter().enumerate().map(of_level).collect::<Result<Vec<_>>>()?, 0)?.unsqueeze(0)
    }
}

impl Projection {
    fn load(weights: &Scope<'_>, inputs: usize, size: usize, is_coarser: bool) -> Loaded<Self> {
        let (convolution, norm) = (weights.sub(0), weights.sub(1));
        let edge = if is_coarser { KERNEL } else { 1 };
        let kernel = convolution.tensor("weight", &[size, inputs, edge, edge])?;
        let bias = convolution.tensor("bias", &[size])?;
        let kernel = kernel.permute((0, 2, 3, 1)).and_then(|kernel| kernel.contiguous()?.flatten_from(1));
        let layer = kernel.and_then(|kernel| Linear::new(&kernel, Some(bias)));
        Ok(Self {
            layer: layer.map_err(|error| convolution.wrong("weight", &error))?,
            weight: norm.state("weight", &[size])?,
            bias: norm.state("bias", &[size])?,
            is_coarser,
        })
    }

    /// Projects a map [height, width, channels] to the width of the states.
    fn of(&self, map: &Tensor) -> Result<Tensor> {
        let map = if self.is_coarser { squares(map)? } else { map.clone() };
        let y = self.layer.of(&map)?;
        let (height, width, size) = y.dims3()?;
        let y = grouped(&y.reshape((height * width, size))?)?;
        y.broadcast_mul(&self.weight)?.broadcast_add(&self.bias)?.reshape((height, width, size))
    }
}

/// The 3 x 3 squares of a map [height, width, channels] around every second cell, with the nine cells of a square side
/// by side: [(height + 1) / 2, (width + 1) / 2, 9 * channels]. Outside of the map there are zeros. A linear layer of
/// these is a convolution.
fn squares(map: &Tensor) -> Result<Tensor> {
    let (height, width, channels) = map.dims3()?;
    let padded = map.pad_with_zeros(0, 1, 1)?.pad_with_zeros(1, 1, 1)?;
    let rows = padded.reshape(((height + 2) * (width + 2), channels))?;
    let (down, across) = (height.div_ceil(STRIDE), width.div_ceil(STRIDE));
    let mut taken = Vec::with_capacity(down * across * KERNEL * KERNEL);
    for (row, column) in (0..down * across).map(|at| (at / across * STRIDE, at % across * STRIDE)) {
        for tap in 0..KERNEL * KERNEL {
            taken.push(((row + tap / KERNEL) * (width + 2) + column + tap % KERNEL) as u32);
        }
    }
    let count = taken.len();
    let taken = Tensor::from_vec(taken, count, map.device())?;
    rows.contiguous()?.index_select(&taken, 0)?.reshape((down, across, KERNEL * KERNEL * channels))
}

/// Normalises cells [cells, size]: mean 0 and variance 1 for each group of channels, over all cells.
fn grouped(x: &Tensor) -> Result<Tensor> {
    let (cells, size) = x.dims2()?;
    let each = size / GROUPS;
    let groups = x.reshape((cells, GROUPS, each))?.transpose(0, 1)?.contiguous()?.reshape((GROUPS, cells * each))?;
    let wide = groups.to_dtype(DType::F32)?;
    let off = wide.broadcast_sub(&wide.mean_keepdim(1)?)?;
    let variance = (off.sqr()?.mean_keepdim(1)? + EPSILON)?;
    let normed = off.broadcast_div(&variance.sqrt()?)?.to_dtype(x.dtype())?;
    normed.reshape((GROUPS, cells, each))?.transpose(0, 1)?.contiguous()?.reshape((cells, size))
}

#[cfg(test)]
mod tests {
    use super::*;
    use candle_core::Device;

    #[test]
    fn squares_times_a_linear_layer_equal_a_convolution() {
        for (height, width) in [(5, 8), (6, 3), (1, 1)] {
            let numbers = |count: usize| (0..count).map(|at| (at * 7 % 11) as f32 - 5.0).collect::<Vec<_>>();
            let map = Tensor::from_vec(numbers(height * width * 2), (height, width, 2), &Device::Cpu).unwrap();
            let kernel = Tensor::from_vec(numbers(3 * 2 * 9), (3, 2, 3, 3), &Device::Cpu).unwrap();
            let rows = kernel.permute((0, 2, 3, 1)).unwrap().contiguous().unwrap().reshape((3, 18)).unwrap();
            let ours = Linear::new(&rows, None).unwrap().of(&squares(&map).unwrap()).unwrap();
            let theirs = map.permute((2, 0, 1)).unwrap().unsqueeze(0).unwrap().conv2d(&kernel, 1, 2, 1, 1).unwrap();
            let theirs = theirs.squeeze(0).unwrap().permute((1, 2, 0)).unwrap();
            assert_eq!(ours.to_vec3::<f32>().unwrap(), theirs.to_vec3::<f32>().unwrap());
        }
    }
}

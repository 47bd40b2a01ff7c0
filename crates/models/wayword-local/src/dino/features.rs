//! Turns a picture into the states of its cells, which do not depend on the text. A cell is one position of a map. The
//! backbone computes maps of the
//! picture at several resolutions. Each is projected to the same width, and becomes one level.

use super::{
    LoadResult,
    config::{DinoConfig, NORM_GROUP_COUNT},
    position,
};
use crate::{
    ops::LinearLayer,
    swin::{SwinBackbone, SwinTensorNames},
    weights::WeightScope,
};
use candle_core::{DType, Result, Tensor};

/// Edge and stride, in cells, of the convolution that makes the levels that are coarser than the backbone's maps.
const KERNEL_EDGE_CELLS: usize = 3;
const KERNEL_STRIDE_CELLS: usize = 2;

/// Added to the variances of groups, so that no division is by 0.
const GROUP_NORM_EPSILON: f64 = 1e-5;

/// Computes the features of pictures.
pub(super) struct DinoFeatureExtractor {
    swin: SwinBackbone,
    projections: Vec<LevelProjection>,
    /// How many maps the backbone has.
    maps: usize,
    /// A learned vector for each level, [levels, size], which is added to the positions of its cells.
    level_embed: Tensor,
    /// The length of a state.
    size: usize,
    /// The temperature of the sines that encode a position.
    temperature: f32,
}

/// The size of a level in cells. Its cells are in rows from the top.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FeatureLevel {
    pub(super) height: usize,
    pub(super) width: usize,
}

/// The features of a picture, before any text.
pub(super) struct PictureFeatures {
    /// The cells of all levels, the finest level first, [1, cells, size].
    pub(super) cells: Tensor,
    pub(super) levels: Vec<FeatureLevel>,
}

/// A convolution and a norm over groups of channels.
struct LevelProjection {
    layer: LinearLayer,
    weight: Tensor,
    bias: Tensor,
    /// Whether it is a 3 x 3 convolution with a stride of 2, or a layer for single cells.
    is_coarser: bool,
}

impl FeatureLevel {
    pub(super) fn cell_count(self) -> usize {
        self.height * self.width
    }

    /// The middles of the cells, as shares of the picture's width and height.
    pub(super) fn cell_middles(self) -> impl Iterator<Item = [f32; 2]> {
        let share = |at: usize, count: usize| (at as f32 + 0.5) / count as f32;
        (0..self.cell_count()).map(move |at| [share(at % self.width, self.width), share(at / self.width, self.height)])
    }
}

impl DinoFeatureExtractor {
    pub(super) fn from_weights(model: &WeightScope<'_>, config: &DinoConfig) -> LoadResult<Self> {
        let backbone = &config.backbone;
        let maps = backbone.outputs.len();
        let width = |map: usize| backbone.outputs.get(map).map_or(config.size, |&stage| backbone.stage_width(stage));
        let projection = |at: usize| {
            let weights = model.sub_scope("input_proj_vision").sub_scope(at);
            // The first coarser level is computed from the backbone's last map, each further one from the level before.
            let inputs = if at == maps { width(maps - 1) } else { width(at) };
            LevelProjection::from_weights(&weights, inputs, config.size, at >= maps)
        };
        Ok(Self {
            swin: SwinBackbone::from_weights(
                &model.sub_scope("backbone.conv_encoder.model"),
                &SwinTensorNames::TRANSFORMERS,
                backbone,
            )?,
            projections: (0..config.levels).map(projection).collect::<LoadResult<_>>()?,
            maps,
            level_embed: model.read_state("level_embed", &[config.levels, config.size])?,
            size: config.size,
            temperature: config.temperature,
        })
    }

    /// The features of a picture with pixels [1, 3, height, width].
    pub(super) fn extract_features(&self, pixels: &Tensor) -> Result<PictureFeatures> {
        let maps: Vec<Tensor> =
            self.swin.extract_features(pixels)?.iter().map(|map| map.squeeze(0)).collect::<Result<_>>()?;
        let mut levels: Vec<Tensor> = Vec::with_capacity(self.projections.len());
        for (at, projection) in self.projections.iter().enumerate() {
            let from = if at <= self.maps { maps.get(at).or(maps.last()) } else { levels.last() };
            let Some(from) = from else { candle_core::bail!("the backbone has no maps") };
            levels.push(projection.project_map(from)?);
        }
        let sizes = levels.iter().map(|level| level.dims3().map(|(height, width, _)| FeatureLevel { height, width }));
        let cells: Vec<Tensor> = levels.iter().map(|level| level.flatten_to(1)).collect::<Result<_>>()?;
        Ok(PictureFeatures { cells: Tensor::cat(&cells, 0)?.unsqueeze(0)?, levels: sizes.collect::<Result<_>>()? })
    }

    /// The encoded positions of all cells, [1, cells, size].
    pub(super) fn cell_positions(&self, levels: &[FeatureLevel]) -> Result<Tensor> {
        let of_level = |(at, level): (usize, &FeatureLevel)| {
            let sines = position::map_positions(level.height, level.width, self.size, self.temperature);
            let sines = Tensor::from_vec(sines, (level.cell_count(), self.size), self.level_embed.device())?;
            sines.to_dtype(self.level_embed.dtype())?.broadcast_add(&self.level_embed.get(at)?)
        };
        Tensor::cat(&levels.iter().enumerate().map(of_level).collect::<Result<Vec<_>>>()?, 0)?.unsqueeze(0)
    }
}

impl LevelProjection {
    fn from_weights(weights: &WeightScope<'_>, inputs: usize, size: usize, is_coarser: bool) -> LoadResult<Self> {
        let (convolution, norm) = (weights.sub_scope(0), weights.sub_scope(1));
        let edge = if is_coarser { KERNEL_EDGE_CELLS } else { 1 };
        let kernel = convolution.read_tensor("weight", &[size, inputs, edge, edge])?;
        let bias = convolution.read_tensor("bias", &[size])?;
        let kernel = kernel.permute((0, 2, 3, 1)).and_then(|kernel| kernel.contiguous()?.flatten_from(1));
        let layer = kernel.and_then(|kernel| LinearLayer::new(&kernel, Some(bias)));
        Ok(Self {
            layer: layer.map_err(|error| convolution.tensor_error("weight", &error))?,
            weight: norm.read_state("weight", &[size])?,
            bias: norm.read_state("bias", &[size])?,
            is_coarser,
        })
    }

    /// Projects a map [height, width, channels] to the width of the states.
    fn project_map(&self, map: &Tensor) -> Result<Tensor> {
        let map = if self.is_coarser { gather_squares(map)? } else { map.clone() };
        let y = self.layer.apply_to(&map)?;
        let (height, width, size) = y.dims3()?;
        let y = normalise_groups(&y.reshape((height * width, size))?)?;
        y.broadcast_mul(&self.weight)?.broadcast_add(&self.bias)?.reshape((height, width, size))
    }
}

/// The 3 x 3 squares of a map [height, width, channels] around every second cell, with the nine cells of a square side
/// by side: [(height + 1) / 2, (width + 1) / 2, 9 * channels]. Outside of the map there are zeros. A linear layer of
/// these is a convolution.
fn gather_squares(map: &Tensor) -> Result<Tensor> {
    let (height, width, channels) = map.dims3()?;
    let padded = map.pad_with_zeros(0, 1, 1)?.pad_with_zeros(1, 1, 1)?;
    let rows = padded.reshape(((height + 2) * (width + 2), channels))?;
    let (down, across) = (height.div_ceil(KERNEL_STRIDE_CELLS), width.div_ceil(KERNEL_STRIDE_CELLS));
    let mut taken = Vec::with_capacity(down * across * KERNEL_EDGE_CELLS * KERNEL_EDGE_CELLS);
    for (row, column) in
        (0..down * across).map(|at| (at / across * KERNEL_STRIDE_CELLS, at % across * KERNEL_STRIDE_CELLS))
    {
        for tap in 0..KERNEL_EDGE_CELLS * KERNEL_EDGE_CELLS {
            taken.push(((row + tap / KERNEL_EDGE_CELLS) * (width + 2) + column + tap % KERNEL_EDGE_CELLS) as u32);
        }
    }
    let count = taken.len();
    let taken = Tensor::from_vec(taken, count, map.device())?;
    rows.contiguous()?.index_select(&taken, 0)?.reshape((
        down,
        across,
        KERNEL_EDGE_CELLS * KERNEL_EDGE_CELLS * channels,
    ))
}

/// Normalises cells [cells, size]: mean 0 and variance 1 for each group of channels, over all cells.
fn normalise_groups(x: &Tensor) -> Result<Tensor> {
    let (cells, size) = x.dims2()?;
    let each = size / NORM_GROUP_COUNT;
    let groups = x
        .reshape((cells, NORM_GROUP_COUNT, each))?
        .transpose(0, 1)?
        .contiguous()?
        .reshape((NORM_GROUP_COUNT, cells * each))?;
    let wide = groups.to_dtype(DType::F32)?;
    let centred = wide.broadcast_sub(&wide.mean_keepdim(1)?)?;
    let variance = (centred.sqr()?.mean_keepdim(1)? + GROUP_NORM_EPSILON)?;
    let normed = centred.broadcast_div(&variance.sqrt()?)?.to_dtype(x.dtype())?;
    normed.reshape((NORM_GROUP_COUNT, cells, each))?.transpose(0, 1)?.contiguous()?.reshape((cells, size))
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
            let ours = LinearLayer::new(&rows, None).unwrap().apply_to(&gather_squares(&map).unwrap()).unwrap();
            let theirs = map.permute((2, 0, 1)).unwrap().unsqueeze(0).unwrap().conv2d(&kernel, 1, 2, 1, 1).unwrap();
            let theirs = theirs.squeeze(0).unwrap().permute((1, 2, 0)).unwrap();
            assert_eq!(ours.to_vec3::<f32>().unwrap(), theirs.to_vec3::<f32>().unwrap());
        }
    }
}

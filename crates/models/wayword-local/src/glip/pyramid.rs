//! The feature pyramid: five levels of the same width from the backbone's three maps. Each coarser map is added to the
//! next finer one, so that fine levels also know the surroundings of a position.

use crate::{
    LocalError,
    ops::{
        LinearLayer,
        conv3::{Conv3Layer, FeatureMap},
    },
    weights::WeightScope,
};
use candle_core::{Result, Tensor};

/// The number of levels. The first has a stride of 8 pixels, and each further one twice that of the level before.
pub(super) const LEVEL_COUNT: usize = 5;

/// Computes the levels of features from the maps of the backbone.
pub(super) struct FeaturePyramid {
    /// The layers for the backbone's maps, the finest first.
    inner: Vec<LinearLayer>,
    /// The convolutions after the sum with the coarser map, the finest first.
    layer: Vec<Conv3Layer>,
    /// The convolutions for the two coarsest levels.
    top: [Conv3Layer; 2],
}

impl FeaturePyramid {
    /// Reads a pyramid for maps of these widths.
    pub(super) fn from_weights(
        weights: &WeightScope<'_>,
        map_widths: [usize; 3],
        width: usize,
    ) -> std::result::Result<Self, LocalError> {
        let inner = |at: usize| {
            let part = weights.sub_scope(format!("fpn_inner{}", at + 2));
            let kernel = part.read_tensor("weight", &[width, map_widths[at], 1, 1])?;
            let bias = part.read_tensor("bias", &[width])?;
            let linear = kernel.flatten_from(1).and_then(|kernel| LinearLayer::new(&kernel, Some(bias)));
            linear.map_err(|error| part.tensor_error("weight", &error))
        };
        let conv = |name: &str| Conv3Layer::from_weights(&weights.sub_scope(name), width, width);
        Ok(Self {
            inner: (0..3).map(inner).collect::<std::result::Result<_, _>>()?,
            layer: (2..5).map(|at| conv(&format!("fpn_layer{at}"))).collect::<std::result::Result<_, _>>()?,
            top: [conv("top_blocks.p6")?, conv("top_blocks.p7")?],
        })
    }

    /// The levels, the finest first, from the backbone's maps [1, height, width, channels], each half as large as the
    /// one before.
    pub(super) fn build_levels(&self, maps: &[Tensor]) -> Result<Vec<FeatureMap>> {
        let mut levels: Vec<FeatureMap> = Vec::with_capacity(LEVEL_COUNT);
        let mut above: Option<Tensor> = None;
        for ((map, inner), layer) in maps.iter().zip(&self.inner).zip(&self.layer).rev() {
            let (_, height, width, _) = map.dims4()?;
            let lateral = inner.apply_to(&map.squeeze(0)?)?;
            let x = match &above {
                None => lateral,
                Some(above) => (lateral + double_size(above)?)?,
            };
            let x_flat = x.flatten_to(1)?;
            levels.insert(0, layer.convolve_plain(&FeatureMap { x: x_flat, height, width }, 1)?);
            above = Some(x);
        }
        let Some(last) = levels.last() else { candle_core::bail!("the backbone gives no maps") };
        let first = self.top[0].convolve_plain(last, 2)?;
        let second = self.top[1].convolve_plain(&FeatureMap { x: first.x.relu()?, ..first }, 2)?;
        levels.extend([first, second]);
        Ok(levels)
    }
}

/// Doubles the edges of x [height, width, channels] by repeating each position four times.
fn double_size(x: &Tensor) -> Result<Tensor> {
    let (height, width, channels) = x.dims3()?;
    let x = x.reshape((height, 1, width, 1, channels))?.broadcast_as((height, 2, width, 2, channels))?;
    x.contiguous()?.reshape((2 * height, 2 * width, channels))
}

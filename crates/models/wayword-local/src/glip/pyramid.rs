//! The feature pyramid: five levels of the same width from the backbone's three maps. Each coarser map is added to the
//! next finer one, so that fine levels also know the surroundings of a position.

use crate::{
    LocalError,
    ops::{
        Linear,
        conv3::{Conv3, Map},
    },
    weights::Scope,
};
use candle_core::{Result, Tensor};

/// The number of levels. The first has a stride of 8 pixels, and each further one twice that of the level before.
pub(super) const LEVELS: usize = 5;

pub(super) struct Pyramid {
    /// The layers for the backbone's maps, the finest first.
    inner: Vec<Linear>,
    layer: Vec<Conv3>,
    /// The convolutions for the two coarsest levels.
    top: [Conv3; 2],
}

impl Pyramid {
    /// Reads a pyramid for maps of these widths.
    pub(super) fn load(weights: &Scope<'_>, from: [usize; 3], width: usize) -> std::result::Result<Self, LocalError> {
        let inner = |at: usize| {
            let part = weights.sub(format!("fpn_inner{}", at + 2));
            let kernel = part.tensor("weight", &[width, from[at], 1, 1])?;
            let bias = part.tensor("bias", &[width])?;
            let linear = kernel.flatten_from(1).and_then(|kernel| Linear::new(&kernel, Some(bias)));
            linear.map_err(|error| part.wrong("weight", &error))
        };
        let conv = |name: &str| Conv3::load(&weights.sub(name), width, width);
        Ok(Self {
            inner: (0..3).map(inner).collect::<std::result::Result<_, _>>()?,
            layer: (2..5).map(|at| conv(&format!("fpn_layer{at}"))).collect::<std::result::Result<_, _>>()?,
            top: [conv("top_blocks.p6")?, conv("top_blocks.p7")?],
        })
    }

    /// The levels, the finest first, from the backbone's maps [1, height, width, channels], each half as large as the
    /// one before.
    pub(super) fn of(&self, maps: &[Tensor]) -> Result<Vec<Map>> {
        let mut levels: Vec<Map> = Vec::with_capacity(LEVELS);
        let mut above: Option<Tensor> = None;
        for ((map, inner), layer) in maps.iter().zip(&self.inner).zip(&self.layer).rev() {
            let (_, height, width, _) = map.dims4()?;
            let lateral = inner.of(&map.squeeze(0)?)?;
            let x = match &above {
                None => lateral,
                Some(above) => (lateral + doubled(above)?)?,
            };
            let x_flat = x.flatten_to(1)?;
            levels.insert(0, layer.plain(&Map { x: x_flat, height, width }, 1)?);
            above = Some(x);
        }
        let Some(last) = levels.last() else { candle_core::bail!("the backbone gives no maps") };
        let first = self.top[0].plain(last, 2)?;
        let second = self.top[1].plain(&Map { x: first.x.relu()?, ..first }, 2)?;
        levels.extend([first, second]);
        Ok(levels)
    }
}

/// Doubles the edges of x [height, width, channels] by repeating each position four times.
fn doubled(x: &Tensor) -> Result<Tensor> {
    let (height, width, channels) = x.dims3()?;
    let x = x.reshape((height, 1, width, 1, channels))?.broadcast_as((height, 2, width, 2, channels))?;
    x.contiguous()?.reshape((2 * height, 2 * width, channels))
}

//! Swin transformers (arXiv 2103.14030): the backbones of GLIP and of Grounding DINO's family.
//!
//! A picture is cut into patches of 4 x 4 pixels. In each block the patches of a small window attend to each other; the
//! windows of every second block are shifted by half a window. Between stages, four neighbours become one. Features are
//! channels-last, [batch, height, width, channels], as the layers that use them expect.

mod attention;
mod block;
mod config;
mod merging;
mod windows;

pub(crate) use config::{Names, SwinConfig};

use crate::{
    LocalError,
    ops::{LayerNorm, Linear, patches},
    weights::Scope,
};
use block::Block;
use candle_core::{Result, Tensor};
use merging::Merging;
use windows::Windows;

/// Edge of a patch, pixels.
const PATCH: usize = 4;

/// A backbone: computes features of a picture at several strides.
pub(crate) struct Swin {
    patch: Linear,
    patch_norm: LayerNorm,
    stages: Vec<Stage>,
    window: usize,
}

struct Stage {
    blocks: Vec<Block>,
    /// The norm of the stage's output, if it is an output of the backbone.
    out: Option<LayerNorm>,
    merging: Option<Merging>,
}

impl Swin {
    /// Reads a backbone from a part of a checkpoint, in which its tensors have these names.
    pub(crate) fn load(
        weights: &Scope<'_>,
        names: &Names,
        config: &SwinConfig,
    ) -> std::result::Result<Self, LocalError> {
        let patch = weights.sub(names.patch);
        let kernel = patch.tensor("weight", &[config.width, 3, PATCH, PATCH])?;
        let bias = patch.tensor("bias", &[config.width])?;
        let linear = kernel.flatten_from(1).and_then(|kernel| Linear::new(&kernel, Some(bias)));
        let stage = |at| Stage::load(weights, names, config, at);
        Ok(Self {
            patch: linear.map_err(|error| patch.wrong("weight", &error))?,
            patch_norm: weights.layer_norm(names.patch_norm, config.width, config.epsilon)?,
            stages: (0..config.depths.len()).map(stage).collect::<std::result::Result<_, _>>()?,
            window: config.window,
        })
    }

    /// The features [batch, height, width, channels] of pixels [batch, 3, height, width], after each stage that is an
    /// output of the backbone, the finest first. Pixels are padded with zeros to whole patches.
    pub(crate) fn of(&self, pixels: &Tensor) -> Result<Vec<Tensor>> {
        let (batch, _, height, width) = pixels.dims4()?;
        let (down, across) = (height.div_ceil(PATCH), width.div_ceil(PATCH));
        let pixels = pixels.pad_with_zeros(2, 0, down * PATCH - height)?;
        let pixels = pixels.pad_with_zeros(3, 0, across * PATCH - width)?;
        let x = self.patch_norm.of(&self.patch.of(&patches(&pixels, PATCH)?)?)?;
        let mut x = x.reshape((batch, down, across, ()))?;
        let mut outputs = Vec::new();
        for stage in &self.stages {
            x = stage.of(x, self.window)?;
            if let Some(norm) = &stage.out {
                outputs.push(norm.of(&x)?);
            }
            if let Some(merging) = &stage.merging {
                x = merging.of(&x)?;
            }
        }
        Ok(outputs)
    }
}

impl Stage {
    fn load(
        weights: &Scope<'_>,
        names: &Names,
        config: &SwinConfig,
        at: usize,
    ) -> std::result::Result<Self, LocalError> {
        let stage = weights.sub(names.stages).sub(at);
        let width = config.width_of(at);
        let block = |block| Block::load(&stage.sub("blocks").sub(block), names, config, at);
        let out = config.outputs.contains(&at);
        let merges = at + 1 < config.depths.len();
        Ok(Self {
            blocks: (0..config.depths[at]).map(block).collect::<std::result::Result<_, _>>()?,
            out: out.then(|| weights.layer_norm(&(names.out_norm)(at), width, config.epsilon)).transpose()?,
            merging: merges.then(|| Merging::load(&stage.sub("downsample"), width, config.epsilon)).transpose()?,
        })
    }

    fn of(&self, x: Tensor, window: usize) -> Result<Tensor> {
        let (_, height, width, _) = x.dims4()?;
        // The windows of every second block are shifted by half a window.
        let plain = Windows::new(height, width, window, 0);
        let moved = (self.blocks.len() > 1).then(|| Windows::new(height, width, window, window / 2));
        self.blocks.iter().enumerate().try_fold(x, |x, (at, block)| match &moved {
            Some(moved) if at % 2 == 1 => block.of(&x, moved),
            _ => block.of(&x, &plain),
        })
    }
}

#[cfg(test)]
mod tests;

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

pub(crate) use config::{SwinConfig, SwinTensorNames};

use crate::{
    LocalError,
    ops::{LayerNorm, LinearLayer, cut_patches},
    weights::WeightScope,
};
use block::SwinBlock;
use candle_core::{Result, Tensor};
use merging::PatchMerging;
use windows::MapWindows;

/// Edge of a patch, pixels.
const PATCH_EDGE_PX: usize = 4;

/// A backbone: computes features of a picture at several strides.
pub(crate) struct SwinBackbone {
    patch: LinearLayer,
    patch_norm: LayerNorm,
    stages: Vec<SwinStage>,
    /// The edge of a window, positions.
    window: usize,
}

/// Blocks at one resolution.
struct SwinStage {
    blocks: Vec<SwinBlock>,
    /// The norm of the stage's output, if it is an output of the backbone.
    out: Option<LayerNorm>,
    /// Halves the resolution for the next stage. The last stage has none.
    merging: Option<PatchMerging>,
}

impl SwinBackbone {
    /// Reads a backbone from a part of a checkpoint, in which its tensors have these names.
    pub(crate) fn from_weights(
        weights: &WeightScope<'_>,
        names: &SwinTensorNames,
        config: &SwinConfig,
    ) -> std::result::Result<Self, LocalError> {
        let patch = weights.sub_scope(names.patch);
        let kernel = patch.read_tensor("weight", &[config.width, 3, PATCH_EDGE_PX, PATCH_EDGE_PX])?;
        let bias = patch.read_tensor("bias", &[config.width])?;
        let linear = kernel.flatten_from(1).and_then(|kernel| LinearLayer::new(&kernel, Some(bias)));
        let stage = |at| SwinStage::from_weights(weights, names, config, at);
        Ok(Self {
            patch: linear.map_err(|error| patch.tensor_error("weight", &error))?,
            patch_norm: weights.read_layer_norm(names.patch_norm, config.width, config.epsilon)?,
            stages: (0..config.depths.len()).map(stage).collect::<std::result::Result<_, _>>()?,
            window: config.window,
        })
    }

    /// The features [batch, height, width, channels] of pixels [batch, 3, height, width], after each stage that is an
    /// output of the backbone, the finest first. Pixels are padded with zeros to whole patches.
    pub(crate) fn extract_features(&self, pixels: &Tensor) -> Result<Vec<Tensor>> {
        let (batch, _, height, width) = pixels.dims4()?;
        let (down, across) = (height.div_ceil(PATCH_EDGE_PX), width.div_ceil(PATCH_EDGE_PX));
        let pixels = pixels.pad_with_zeros(2, 0, down * PATCH_EDGE_PX - height)?;
        let pixels = pixels.pad_with_zeros(3, 0, across * PATCH_EDGE_PX - width)?;
        let x = self.patch_norm.apply_to(&self.patch.apply_to(&cut_patches(&pixels, PATCH_EDGE_PX)?)?)?;
        let mut x = x.reshape((batch, down, across, ()))?;
        let mut outputs = Vec::new();
        for stage in &self.stages {
            x = stage.apply_blocks(x, self.window)?;
            if let Some(norm) = &stage.out {
                outputs.push(norm.apply_to(&x)?);
            }
            if let Some(merging) = &stage.merging {
                x = merging.merge_squares(&x)?;
            }
        }
        Ok(outputs)
    }
}

impl SwinStage {
    fn from_weights(
        weights: &WeightScope<'_>,
        names: &SwinTensorNames,
        config: &SwinConfig,
        at: usize,
    ) -> std::result::Result<Self, LocalError> {
        let stage = weights.sub_scope(names.stages).sub_scope(at);
        let width = config.stage_width(at);
        let block = |block| SwinBlock::from_weights(&stage.sub_scope("blocks").sub_scope(block), names, config, at);
        let out = config.outputs.contains(&at);
        let merges = at + 1 < config.depths.len();
        Ok(Self {
            blocks: (0..config.depths[at]).map(block).collect::<std::result::Result<_, _>>()?,
            out: out.then(|| weights.read_layer_norm(&(names.out_norm)(at), width, config.epsilon)).transpose()?,
            merging: merges
                .then(|| PatchMerging::from_weights(&stage.sub_scope("downsample"), width, config.epsilon))
                .transpose()?,
        })
    }

    fn apply_blocks(&self, x: Tensor, window: usize) -> Result<Tensor> {
        let (_, height, width, _) = x.dims4()?;
        // The windows of every second block are shifted by half a window.
        let plain = MapWindows::new(height, width, window, 0);
        let shifted = (self.blocks.len() > 1).then(|| MapWindows::new(height, width, window, window / 2));
        self.blocks.iter().enumerate().try_fold(x, |x, (at, block)| match &shifted {
            Some(shifted) if at % 2 == 1 => block.apply_to(&x, shifted),
            _ => block.apply_to(&x, &plain),
        })
    }
}

#[cfg(test)]
mod tests;

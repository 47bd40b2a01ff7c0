//! The whole network: the backbone turns a picture into levels of features, BERT turns a text into states, and the head
//! joins both.

use super::{
    config::Config,
    head::{Head, Said},
    pyramid::{LEVELS, Pyramid},
};
use crate::{
    LocalError, bert,
    ops::conv3::Map,
    swin::{Names, Swin},
    weights::Weights,
};
use candle_core::{Result, Tensor};

pub(super) struct Model {
    backbone: Swin,
    pyramid: Pyramid,
    text: bert::Encoder,
    head: Head,
    width: usize,
}

impl Model {
    pub(super) fn load(weights: &Weights, config: &Config) -> std::result::Result<Self, LocalError> {
        let all = weights.scope("");
        let from = [1, 2, 3].map(|stage| config.swin.width_of(stage));
        Ok(Self {
            backbone: Swin::load(&all.sub("backbone.body"), &Names::ORIGINAL, &config.swin)?,
            pyramid: Pyramid::load(&all.sub("backbone.fpn"), from, config.head.width)?,
            text: bert::Encoder::load(&all.sub("language_backbone.body.model"), &config.text)?,
            head: Head::load(&all.sub("rpn.head"), config)?,
            width: config.head.width,
        })
    }

    /// The levels of a picture [1, 3, height, width]. Height and width are multiples of 32.
    pub(super) fn levels(&self, pixels: &Tensor) -> Result<Vec<Map>> {
        self.pyramid.of(&self.backbone.of(pixels)?)
    }

    /// The states [tokens, size] of a text.
    pub(super) fn states(&self, ids: &[u32], device: &candle_core::Device) -> Result<Tensor> {
        self.text.of(&Tensor::new(ids, device)?.unsqueeze(0)?, None)?.squeeze(0)
    }

    /// The head's outputs for the levels of a picture and the states of a text.
    pub(super) fn said(&self, levels: &[Map], text: &Tensor) -> Result<Vec<Said>> {
        self.head.of(levels, text)
    }

    /// Bytes of the levels of a picture of this many pixels, in 32 bits.
    pub(super) fn bytes(&self, pixels: usize) -> usize {
        let positions: usize = (0..LEVELS).map(|level| pixels.div_ceil(64 << (2 * level))).sum();
        positions * self.width * 4
    }
}

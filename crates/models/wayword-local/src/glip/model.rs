//! The whole network: the backbone turns a picture into levels of features, BERT turns a text into states, and the head
//! joins both.

use super::{
    config::GlipConfig,
    head::{GlipHead, GlipLevelOutputs},
    pyramid::{FeaturePyramid, LEVEL_COUNT},
};
use crate::{
    LocalError, bert,
    ops::conv3::FeatureMap,
    swin::{SwinBackbone, SwinTensorNames},
    weights::CheckpointWeights,
};
use candle_core::{Result, Tensor};

/// The network of a GLIP.
pub(super) struct GlipModel {
    backbone: SwinBackbone,
    pyramid: FeaturePyramid,
    text: bert::BertEncoder,
    head: GlipHead,
    /// The channels of the features.
    width: usize,
}

impl GlipModel {
    pub(super) fn from_weights(
        weights: &CheckpointWeights,
        config: &GlipConfig,
    ) -> std::result::Result<Self, LocalError> {
        let all = weights.scope_under("");
        let map_widths = [1, 2, 3].map(|stage| config.swin.stage_width(stage));
        Ok(Self {
            backbone: SwinBackbone::from_weights(
                &all.sub_scope("backbone.body"),
                &SwinTensorNames::ORIGINAL,
                &config.swin,
            )?,
            pyramid: FeaturePyramid::from_weights(&all.sub_scope("backbone.fpn"), map_widths, config.head.width)?,
            text: bert::BertEncoder::from_weights(&all.sub_scope("language_backbone.body.model"), &config.text)?,
            head: GlipHead::from_weights(&all.sub_scope("rpn.head"), config)?,
            width: config.head.width,
        })
    }

    /// The levels of a picture [1, 3, height, width]. Height and width are multiples of 32.
    pub(super) fn feature_levels(&self, pixels: &Tensor) -> Result<Vec<FeatureMap>> {
        self.pyramid.build_levels(&self.backbone.extract_features(pixels)?)
    }

    /// The states [tokens, size] of a text.
    pub(super) fn text_states(&self, ids: &[u32], device: &candle_core::Device) -> Result<Tensor> {
        self.text.encode_tokens(&Tensor::new(ids, device)?.unsqueeze(0)?, None)?.squeeze(0)
    }

    /// The head's outputs for the levels of a picture and the states of a text.
    pub(super) fn head_outputs(&self, levels: &[FeatureMap], text: &Tensor) -> Result<Vec<GlipLevelOutputs>> {
        self.head.run_rounds(levels, text)
    }

    /// Bytes of the levels of a picture of this many pixels, in 32 bits.
    pub(super) fn feature_bytes(&self, pixels: usize) -> usize {
        // A position of the first level covers 8 x 8 pixels, and one of each further level four times as many.
        let positions: usize = (0..LEVEL_COUNT).map(|level| pixels.div_ceil(64 << (2 * level))).sum();
        positions * self.width * 4
    }
}

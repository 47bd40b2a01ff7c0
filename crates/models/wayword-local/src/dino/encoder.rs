//! The encoder: in each layer picture and text look at each other, then tokens at tokens, and cells at other cells.

use super::{
    config::DinoConfig,
    deformable::{DeformableAttention, SamplingOrigin},
    features::FeatureLevel,
    fusion::DinoFusion,
    layers::{NormedFeedForward, ProjectedAttention},
    text::PromptStates,
};
use crate::{LocalError, ops::LayerNorm, weights::WeightScope};
use candle_core::{Result, Tensor};

/// One layer of the encoder: `fusion` lets cells and tokens look at each other, `text_..` lets tokens look at tokens,
/// and `look` lets cells look at other cells.
pub(super) struct EncoderLayer {
    fusion: DinoFusion,
    text_mix: ProjectedAttention,
    text_norm: LayerNorm,
    text_feed: NormedFeedForward,
    look: DeformableAttention,
    norm: LayerNorm,
    feed: NormedFeedForward,
}

impl EncoderLayer {
    pub(super) fn from_weights(
        weights: &WeightScope<'_>,
        config: &DinoConfig,
    ) -> std::result::Result<Self, LocalError> {
        let (size, inner, epsilon) = (config.size, config.encoder.inner, config.epsilon);
        let (text, cells) = (weights.sub_scope("text_enhancer_layer"), weights.sub_scope("deformable_layer"));
        let feed = |scope: &WeightScope<'_>, norm, inner| {
            NormedFeedForward::from_weights(scope, norm, (size, inner), config.activation, epsilon)
        };
        Ok(Self {
            fusion: DinoFusion::from_weights(&weights.sub_scope("fusion_layer"), config)?,
            text_mix: ProjectedAttention::from_weights(&text.sub_scope("self_attn"), size, config.encoder.heads / 2)?,
            text_norm: text.read_layer_norm("layer_norm_before", size, epsilon)?,
            text_feed: feed(&text, "layer_norm_after", inner / 2)?,
            look: DeformableAttention::from_weights(
                &cells.sub_scope("self_attn"),
                size,
                config.levels,
                config.encoder,
            )?,
            norm: cells.read_layer_norm("self_attn_layer_norm", size, epsilon)?,
            feed: feed(&cells, "final_layer_norm", inner)?,
        })
    }

    /// Computes the next states of the cells [1, cells, size] and of the text's tokens [1, tokens, size].
    pub(super) fn apply_to(
        &self,
        cells: &Tensor,
        states: &Tensor,
        (positions, levels): (&Tensor, &[FeatureLevel]),
        text: &PromptStates,
    ) -> Result<(Tensor, Tensor)> {
        let (cells, states) = self.fusion.fuse_states(cells, states)?;
        let placed = (&states + &text.places)?;
        let mixed = self.text_mix.attend_to(&placed, &placed, &states, Some(&text.mask))?;
        let states = self.text_feed.apply_to(&self.text_norm.apply_to(&(states + mixed)?)?)?;
        let seen = self.look.sample_cells(&(&cells + positions)?, &cells, levels, SamplingOrigin::Cells)?;
        let cells = self.feed.apply_to(&self.norm.apply_to(&(cells + seen)?)?)?;
        Ok((cells, states))
    }
}

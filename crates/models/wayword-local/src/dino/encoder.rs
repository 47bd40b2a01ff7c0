//! The encoder: in each layer picture and text look at each other, then tokens at tokens, and cells at other cells.

use super::{
    config::Config,
    deformable::{Deformable, Origin},
    features::Level,
    fusion::Fusion,
    layers::{Feed, Mixing},
    text::Text,
};
use crate::{LocalError, ops::LayerNorm, weights::Scope};
use candle_core::{Result, Tensor};

/// One layer of the encoder.
pub(super) struct EncoderLayer {
    fusion: Fusion,
    text_mix: Mixing,
    text_norm: LayerNorm,
    text_feed: Feed,
    look: Deformable,
    norm: LayerNorm,
    feed: Feed,
}

impl EncoderLayer {
    pub(super) fn load(weights: &Scope<'_>, config: &Config) -> std::result::Result<Self, LocalError> {
        let (size, inner, epsilon) = (config.size, config.encoder.inner, config.epsilon);
        let (text, cells) = (weights.sub("text_enhancer_layer"), weights.sub("deformable_layer"));
        let feed = |of: &Scope<'_>, norm, inner| Feed::load(of, norm, (size, inner), config.activation, epsilon);
        Ok(Self {
            fusion: Fusion::load(&weights.sub("fusion_layer"), config)?,
            text_mix: Mixing::load(&text.sub("self_attn"), size, config.encoder.heads / 2)?,
            text_norm: text.layer_norm("layer_norm_before", size, epsilon)?,
            text_feed: feed(&text, "layer_norm_after", inner / 2)?,
            look: Deformable::load(&cells.sub("self_attn"), size, config.levels, config.encoder)?,
            norm: cells.layer_norm("self_attn_layer_norm", size, epsilon)?,
            feed: feed(&cells, "final_layer_norm", inner)?,
        })
    }

    /// Computes the next states of the cells [1, cells, size] and of the text's tokens [1, tokens, size].
    pub(super) fn of(
        &self,
        cells: &Tensor,
        states: &Tensor,
        (positions, levels): (&Tensor, &[Level]),
        text: &Text,
    ) -> Result<(Tensor, Tensor)> {
        let (cells, states) = self.fusion.of(cells, states)?;
        let placed = (&states + &text.places)?;
        let mixed = self.text_mix.of(&placed, &placed, &states, Some(&text.mask))?;
        let states = self.text_feed.of(&self.text_norm.of(&(states + mixed)?)?)?;
        let seen = self.look.of(&(&cells + positions)?, &cells, levels, Origin::Cells)?;
        let cells = self.feed.of(&self.norm.of(&(cells + seen)?)?)?;
        Ok((cells, states))
    }
}

//! Turns the text of a prompt into states: BERT reads it, and a projection brings its states to the width of the
//! picture's states.

use super::{config::DinoConfig, position, prompt::DinoPrompt};
use crate::{LocalError, bert::BertEncoder, ops::LinearLayer, weights::WeightScope};
use candle_core::{DType, Device, Result, Tensor};

/// Computes the states of a prompt's tokens.
pub(super) struct TextTower {
    bert: BertEncoder,
    projection: LinearLayer,
    size: usize,
}

/// The states of a prompt's tokens. They are the same for all pictures.
pub(super) struct PromptStates {
    /// The states, [1, tokens, size].
    pub(super) states: Tensor,
    /// The encoded positions of the tokens in their phrases, [1, tokens, size].
    pub(super) places: Tensor,
    /// The mask [1, 1, tokens, tokens] that hides other phrases from a token.
    pub(super) mask: Tensor,
}

impl TextTower {
    pub(super) fn from_weights(model: &WeightScope<'_>, config: &DinoConfig) -> std::result::Result<Self, LocalError> {
        Ok(Self {
            bert: BertEncoder::from_weights(&model.sub_scope("text_backbone"), &config.text)?,
            projection: model.read_linear("text_projection", config.text.hidden_size, config.size)?,
            size: config.size,
        })
    }

    /// Computes the states of a prompt's tokens.
    pub(super) fn encode_prompt(&self, prompt: &DinoPrompt, device: &Device) -> Result<PromptStates> {
        let count = prompt.ids.len();
        let ids = Tensor::from_slice(&prompt.ids, (1, count), device)?;
        let places = prompt.token_places();
        let mask = prompt.attention_mask(device)?.reshape((1, 1, count, count))?;
        let at = Tensor::from_slice(&places, count, device)?;
        let states = self.projection.apply_to(&self.bert.encode_tokens_at(&ids, &at, Some(&mask))?)?;
        let places = Tensor::from_vec(position::token_positions(&places, self.size), (1, count, self.size), device)?;
        let places = if device.is_cpu() { places.to_dtype(DType::F32)? } else { places.to_dtype(states.dtype())? };
        Ok(PromptStates { states, places, mask })
    }
}

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

    /// Computes all that the layers need of a prompt: the states of its tokens, their places in their phrases, and the mask.
    pub(super) fn encode_prompt(&self, prompt: &DinoPrompt, device: &Device) -> Result<PromptStates> {
        let count = prompt.ids.len();
        let ids = Tensor::from_slice(&prompt.ids, (1, count), device)?;
        let token_places = prompt.token_places();
        let mask = prompt.attention_mask(device)?.reshape((1, 1, count, count))?;
        let place_tensor = Tensor::from_slice(&token_places, count, device)?;
        let states = self.projection.apply_to(&self.bert.encode_tokens_at(&ids, &place_tensor, Some(&mask))?)?;
        let encoded =
            Tensor::from_vec(position::token_positions(&token_places, self.size), (1, count, self.size), device)?;
        // On the CPU the layers compute in 32 bits, whatever type the weights have; elsewhere in the type of the weights.
        let places = if device.is_cpu() { encoded.to_dtype(DType::F32)? } else { encoded.to_dtype(states.dtype())? };
        Ok(PromptStates { states, places, mask })
    }
}

//! The output layers: they turn states into scores for each token, and into movements of boxes.

use super::{
    LoadResult,
    config::{DinoConfig, DinoFamily},
    layers::ReluPerceptron,
};
use crate::weights::WeightScope;
use candle_core::{DType, Result, Tensor};

/// Scores how well states fit tokens: their dot product times `scale`, plus `bias`.
pub(super) struct TokenContrast {
    scale: f64,
    bias: f64,
}

impl TokenContrast {
    pub(super) fn from_weights(weights: &WeightScope<'_>, config: &DinoConfig) -> LoadResult<Self> {
        if config.family == DinoFamily::Plain {
            return Ok(Self { scale: 1.0, bias: 0.0 });
        }
        let bias = weights.read_tensor("bias", &[])?;
        let bias = bias.to_dtype(DType::F32).and_then(|bias| bias.to_scalar::<f32>());
        let bias = bias.map_err(|error| weights.tensor_error("bias", &error))?;
        Ok(Self { scale: 1.0 / (config.size as f64).sqrt(), bias: f64::from(bias) })
    }

    /// Logits [rows, tokens] of states [1, rows, size] and a text [1, tokens, size].
    pub(super) fn token_logits(&self, states: &Tensor, text: &Tensor) -> Result<Tensor> {
        let logits = states.squeeze(0)?.matmul(&text.squeeze(0)?.t()?)?;
        logits.affine(self.scale, self.bias)
    }
}

/// The heads of the decoder's layers.
pub(super) struct DinoHeads {
    /// The networks that compute the movements of boxes: one for each layer of the decoder, or one for all.
    boxes: Vec<ReluPerceptron>,
    /// Scores of the last layer's states.
    pub(super) contrast: TokenContrast,
}

impl DinoHeads {
    /// Reads the heads from a whole checkpoint. They are at the top of it, or within the decoder, or in both places.
    pub(super) fn from_weights(all: &WeightScope<'_>, config: &DinoConfig) -> LoadResult<Self> {
        let head = |name: &str, shares: bool, layer: usize, tensor: &str| {
            let layer = if shares { 0 } else { layer };
            let (at_top, in_decoder) =
                (all.sub_scope(name).sub_scope(layer), all.sub_scope("model.decoder").sub_scope(name).sub_scope(layer));
            if !at_top.has_tensor(tensor) && in_decoder.has_tensor(tensor) { in_decoder } else { at_top }
        };
        let last = config.decoder.count - 1;
        let widths = [config.size, config.size, config.size, 4];
        let count = if config.shares_boxes { 1 } else { config.decoder.count };
        let box_head = |layer| {
            let weights = head("bbox_embed", config.shares_boxes, layer, "layers.0.weight");
            ReluPerceptron::from_weights(&weights, &widths)
        };
        Ok(Self {
            boxes: (0..count).map(box_head).collect::<LoadResult<_>>()?,
            contrast: TokenContrast::from_weights(&head("class_embed", config.shares_classes, last, "bias"), config)?,
        })
    }

    /// How far the states of a layer move their boxes, [1, queries, 4].
    pub(super) fn box_moves(&self, layer: usize, states: &Tensor) -> Result<Tensor> {
        match self.boxes.get(layer).or(self.boxes.first()) {
            Some(boxes) => boxes.apply_to(states),
            None => candle_core::bail!("there is no head for boxes"),
        }
    }
}

//! BLIP's vision transformer: a picture is cut into patches, and each gets a state. BLIP-2 has the same architecture.

use super::config::VisionConfig;
use crate::{
    LocalError,
    ops::{Activation, FeedForward, LayerNorm, LinearLayer, MultiHeadAttention, cut_patches},
    weights::WeightScope,
};
use candle_core::{Result, Tensor};

/// Computes the states of the patches of pictures.
pub(crate) struct BlipVision {
    /// Turns the pixels of a patch into its first state.
    patch: LinearLayer,
    /// The edge of a patch.
    patch_px: usize,
    /// The first state of the class token, which represents the whole picture, [1, 1, size].
    class: Tensor,
    positions: Tensor,
    layers: Vec<BlipVisionLayer>,
    norm: LayerNorm,
}

/// One layer: attention among the patches, then a feed-forward network, each with a norm before it.
struct BlipVisionLayer {
    norm: LayerNorm,
    /// The layer for queries, keys and values, side by side.
    qkv: LinearLayer,
    /// The layer behind the attention, and the norm before the feed-forward network.
    mixed: LinearLayer,
    mixed_norm: LayerNorm,
    /// The feed-forward network: from the width of a state to the inner width, and back.
    wide: LinearLayer,
    narrow: LinearLayer,
    heads: usize,
    activation: Activation,
}

impl BlipVision {
    pub(crate) fn from_weights(
        weights: &WeightScope<'_>,
        config: &VisionConfig,
    ) -> std::result::Result<Self, LocalError> {
        let (size, patch_px) = (config.hidden_size, config.patch_size);
        let embeddings = weights.sub_scope("embeddings");
        let count = (config.image_size / patch_px).pow(2) + 1;
        let kernel = embeddings.read_tensor("patch_embedding.weight", &[size, 3, patch_px, patch_px])?;
        let bias = embeddings.read_tensor("patch_embedding.bias", &[size])?;
        let patch = kernel.flatten_from(1).and_then(|kernel| LinearLayer::new(&kernel, Some(bias)));
        let layers = (0..config.num_hidden_layers)
            .map(|layer| BlipVisionLayer::from_weights(&weights.sub_scope("encoder.layers").sub_scope(layer), config));
        Ok(Self {
            patch: patch.map_err(|error| embeddings.tensor_error("patch_embedding.weight", &error))?,
            patch_px,
            class: embeddings.read_state("class_embedding", &[1, 1, size])?,
            positions: embeddings.read_state("position_embedding", &[1, count, size])?,
            layers: layers.collect::<std::result::Result<_, _>>()?,
            norm: weights.read_layer_norm("post_layernorm", size, config.layer_norm_eps)?,
        })
    }

    /// The states [batch, patches + 1, size] of pictures [batch, 3, height, width]. The first state is the class
    /// token's.
    pub(crate) fn encode_pictures(&self, pictures: &Tensor) -> Result<Tensor> {
        let pictures = pictures.to_dtype(self.class.dtype())?;
        let x = self.patch.apply_to(&cut_patches(&pictures, self.patch_px)?)?;
        let (batch, _, size) = x.dims3()?;
        let x = Tensor::cat(&[&self.class.expand((batch, 1, size))?.contiguous()?, &x], 1)?;
        let x = x.broadcast_add(&self.positions)?;
        self.norm.apply_to(&self.layers.iter().try_fold(x, |x, layer| layer.apply_to(&x))?)
    }
}

impl BlipVisionLayer {
    fn from_weights(weights: &WeightScope<'_>, config: &VisionConfig) -> std::result::Result<Self, LocalError> {
        let (size, inner, epsilon) = (config.hidden_size, config.intermediate_size, config.layer_norm_eps);
        Ok(Self {
            norm: weights.read_layer_norm("layer_norm1", size, epsilon)?,
            qkv: weights.read_linear("self_attn.qkv", size, 3 * size)?,
            mixed: weights.read_linear("self_attn.projection", size, size)?,
            mixed_norm: weights.read_layer_norm("layer_norm2", size, epsilon)?,
            wide: weights.read_linear("mlp.fc1", size, inner)?,
            narrow: weights.read_linear("mlp.fc2", inner, size)?,
            heads: config.num_attention_heads,
            activation: config.hidden_act,
        })
    }

    fn apply_to(&self, x: &Tensor) -> Result<Tensor> {
        let size = x.dim(2)?;
        let qkv = self.qkv.apply_to_normed(x, &self.norm)?;
        let part = |at: usize| qkv.narrow(2, at * size, size);
        let scale = 1.0 / ((size / self.heads) as f32).sqrt();
        let mixed =
            MultiHeadAttention { heads: self.heads, scale, bias: None }.attend_to(&part(0)?, &part(1)?, &part(2)?)?;
        let feed_forward = FeedForward {
            before: Some(&self.mixed_norm),
            wide: &self.wide,
            activation: self.activation,
            narrow: &self.narrow,
            after: None,
        };
        feed_forward.apply_to(&self.mixed.apply_and_add(&mixed, x)?)
    }
}

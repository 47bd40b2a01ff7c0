//! CLIP's vision tower (transformers' `CLIPVisionModel`): states of a picture and its patches.

use super::{config::VisionConfig, layers::ClipLayers};
use crate::{
    LocalError,
    ops::{LayerNorm, LinearLayer, cut_patches},
    weights::WeightScope,
};
use candle_core::{DType, Result, Tensor};

/// Computes one state for each picture, or the states of all its tokens.
pub(crate) struct VisionTower {
    /// The edge of a patch, pixels.
    patch_size: usize,
    /// Turns the pixels of a patch into its first state.
    patches: LinearLayer,
    /// The class token with its position, [1, 1, size]. It comes before the patches, and its state is the result.
    class: Tensor,
    /// The positions of the patches, [patches, size].
    positions: Tensor,
    first_norm: LayerNorm,
    layers: ClipLayers,
    last_norm: LayerNorm,
}

impl VisionTower {
    /// The tower of a part of a checkpoint. `first_norm` is the name of the norm before the layers.
    pub(crate) fn from_weights(
        weights: &WeightScope<'_>,
        config: &VisionConfig,
        first_norm: &str,
    ) -> std::result::Result<Self, LocalError> {
        let (size, patch, epsilon) = (config.layers.hidden_size, config.patch_size, config.layers.layer_norm_eps);
        let embeddings = weights.sub_scope("embeddings");
        let count = (config.image_size / patch).pow(2);
        let kernel = embeddings.read_tensor("patch_embedding.weight", &[size, 3, patch, patch])?;
        let kernel = kernel.flatten_from(1).and_then(|kernel| LinearLayer::new(&kernel, None));
        let class = embeddings.read_tensor("class_embedding", &[size])?;
        let positions = embeddings.read_tensor("position_embedding.weight", &[count + 1, size])?;
        let class_and_positions =
            split_positions(&class, &positions).map_err(|error| embeddings.tensor_error("class_embedding", &error))?;
        Ok(Self {
            patch_size: patch,
            patches: kernel.map_err(|error| embeddings.tensor_error("patch_embedding.weight", &error))?,
            class: class_and_positions.0,
            positions: class_and_positions.1,
            first_norm: weights.read_layer_norm(first_norm, size, epsilon)?,
            layers: ClipLayers::from_weights(&weights.sub_scope("encoder.layers"), &config.layers)?,
            last_norm: weights.read_layer_norm("post_layernorm", size, epsilon)?,
        })
    }

    /// The states [batch, 1, size] of the class tokens of pictures [batch, 3, height, width] in 32 bits.
    pub(crate) fn encode_pictures(&self, pictures: &Tensor) -> Result<Tensor> {
        let x = self.layers.states_at(self.embed_patches(pictures)?, None, &vec![0; pictures.dim(0)?])?;
        self.last_norm.apply_to(&x)
    }

    /// The states [batch, 1 + patches, size] of all tokens of pictures [batch, 3, height, width] in 32 bits: the class
    /// token, then the patches, rows from the top.
    pub(crate) fn encode_all_tokens(&self, pictures: &Tensor) -> Result<Tensor> {
        self.last_norm.apply_to(&self.layers.apply_to_all(self.embed_patches(pictures)?, None)?)
    }

    /// The input of the layers, [batch, 1 + patches, size]: the class token and the patches, with their positions.
    fn embed_patches(&self, pictures: &Tensor) -> Result<Tensor> {
        let batch = pictures.dim(0)?;
        let cut = cut_patches(&pictures.to_dtype(self.positions.dtype())?, self.patch_size)?;
        let patch_states = self.patches.apply_to(&cut)?.broadcast_add(&self.positions)?;
        let size = patch_states.dim(2)?;
        let x = Tensor::cat(&[&self.class.expand((batch, 1, size))?, &patch_states], 1)?;
        self.first_norm.apply_to(&x)
    }
}

/// The class token with its position added, and the positions of the patches. On the CPU they have 32 bits.
fn split_positions(class: &Tensor, positions: &Tensor) -> Result<(Tensor, Tensor)> {
    let widen = |tensor: &Tensor| match tensor.device().is_cpu() {
        true => tensor.to_dtype(DType::F32),
        false => Ok(tensor.clone()),
    };
    let (class, positions) = (widen(class)?, widen(positions)?);
    let class = (class + positions.get(0)?)?.reshape((1, 1, ()))?;
    Ok((class, positions.narrow(0, 1, positions.dim(0)? - 1)?.contiguous()?))
}

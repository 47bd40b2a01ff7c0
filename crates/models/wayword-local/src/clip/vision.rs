//! CLIP's vision tower (transformers' `CLIPVisionModel`): states of a picture and its patches.

use super::{config::VisionConfig, layers::Layers};
use crate::{
    LocalError,
    ops::{LayerNorm, Linear, patches},
    weights::Scope,
};
use candle_core::{DType, Result, Tensor};

/// Computes one state for each picture, or the states of all its tokens.
pub(crate) struct VisionTower {
    patch_size: usize,
    patches: Linear,
    /// The class token with its position, [1, 1, size]. It comes before the patches, and its state is the result.
    class: Tensor,
    /// The positions of the patches, [patches, size].
    positions: Tensor,
    first_norm: LayerNorm,
    layers: Layers,
    last_norm: LayerNorm,
}

impl VisionTower {
    /// The tower of a part of a checkpoint. `first_norm` is the name of the norm before the layers.
    pub(crate) fn load(
        weights: &Scope<'_>,
        config: &VisionConfig,
        first_norm: &str,
    ) -> std::result::Result<Self, LocalError> {
        let (size, patch, epsilon) = (config.layers.hidden_size, config.patch_size, config.layers.layer_norm_eps);
        let embeddings = weights.sub("embeddings");
        let count = (config.image_size / patch).pow(2);
        let kernel = embeddings.tensor("patch_embedding.weight", &[size, 3, patch, patch])?;
        let kernel = kernel.flatten_from(1).and_then(|kernel| Linear::new(&kernel, None));
        let class = embeddings.tensor("class_embedding", &[size])?;
        let positions = embeddings.tensor("position_embedding.weight", &[count + 1, size])?;
        let placed = placed(&class, &positions).map_err(|error| embeddings.wrong("class_embedding", &error))?;
        Ok(Self {
            patch_size: patch,
            patches: kernel.map_err(|error| embeddings.wrong("patch_embedding.weight", &error))?,
            class: placed.0,
            positions: placed.1,
            first_norm: weights.layer_norm(first_norm, size, epsilon)?,
            layers: Layers::load(&weights.sub("encoder.layers"), &config.layers)?,
            last_norm: weights.layer_norm("post_layernorm", size, epsilon)?,
        })
    }

    /// The states [batch, 1, size] of the class tokens of pictures [batch, 3, height, width] in 32 bits.
    pub(crate) fn of(&self, pictures: &Tensor) -> Result<Tensor> {
        let x = self.layers.of(self.tokens(pictures)?, None, &vec![0; pictures.dim(0)?])?;
        self.last_norm.of(&x)
    }

    /// The states [batch, 1 + patches, size] of all tokens of pictures [batch, 3, height, width] in 32 bits: the class
    /// token, then the patches, rows from the top.
    pub(crate) fn all(&self, pictures: &Tensor) -> Result<Tensor> {
        self.last_norm.of(&self.layers.all(self.tokens(pictures)?, None)?)
    }

    /// The input of the layers, [batch, 1 + patches, size]: the class token and the patches, with their positions.
    fn tokens(&self, pictures: &Tensor) -> Result<Tensor> {
        let batch = pictures.dim(0)?;
        let cut = patches(&pictures.to_dtype(self.positions.dtype())?, self.patch_size)?;
        let seen = self.patches.of(&cut)?.broadcast_add(&self.positions)?;
        let size = seen.dim(2)?;
        let x = Tensor::cat(&[&self.class.expand((batch, 1, size))?, &seen], 1)?;
        self.first_norm.of(&x)
    }
}

/// The class token with its position added, and the positions of the patches. On the CPU they have 32 bits.
fn placed(class: &Tensor, positions: &Tensor) -> Result<(Tensor, Tensor)> {
    let wide = |tensor: &Tensor| match tensor.device().is_cpu() {
        true => tensor.to_dtype(DType::F32),
        false => Ok(tensor.clone()),
    };
    let (class, positions) = (wide(class)?, wide(positions)?);
    let class = (class + positions.get(0)?)?.reshape((1, 1, ()))?;
    Ok((class, positions.narrow(0, 1, positions.dim(0)? - 1)?.contiguous()?))
}

//! A part of a checkpoint: the tensors that share a prefix of their names, such as `encoder.layer.3`. Layers are read
//! from it.

use super::CheckpointWeights;
use crate::{
    LocalError,
    ops::{EmbeddingTable, LayerNorm, LinearLayer, RmsNorm},
};
use candle_core::{DType, Tensor};

/// The tensors of a checkpoint with names that begin with a prefix.
#[derive(Clone)]
pub(crate) struct WeightScope<'a> {
    weights: &'a CheckpointWeights,
    prefix: String,
}

impl<'a> WeightScope<'a> {
    pub(super) fn new(weights: &'a CheckpointWeights, prefix: &str) -> Self {
        Self { weights, prefix: prefix.to_owned() }
    }

    /// The part with this name, or with the number of a layer, within this part.
    pub(crate) fn sub_scope(&self, name: impl std::fmt::Display) -> Self {
        Self { weights: self.weights, prefix: self.full_name(&name.to_string()) }
    }

    fn full_name(&self, name: &str) -> String {
        if self.prefix.is_empty() { name.to_owned() } else { format!("{}.{name}", self.prefix) }
    }

    /// Whether there is a tensor of this name.
    pub(crate) fn has_tensor(&self, name: &str) -> bool {
        self.weights.has_tensor(&self.full_name(name))
    }

    /// Reads a tensor, and checks its shape.
    pub(crate) fn read_tensor(&self, name: &str, shape: &[usize]) -> Result<Tensor, LocalError> {
        self.weights.read_tensor(&self.full_name(name), shape)
    }

    /// Reads a tensor that is added to the model's states, and checks its shape. States have 32 bits on the CPU,
    /// whatever the precision of the weights, so this tensor has too.
    pub(crate) fn read_state(&self, name: &str, shape: &[usize]) -> Result<Tensor, LocalError> {
        let tensor = self.read_tensor(name, shape)?;
        if !tensor.device().is_cpu() {
            return Ok(tensor);
        }
        tensor.to_dtype(DType::F32).map_err(|error| self.tensor_error(name, &error))
    }

    /// Reads a linear layer: `weight` [outputs, inputs] and, if there is one, `bias` [outputs].
    pub(crate) fn read_linear(&self, layer: &str, inputs: usize, outputs: usize) -> Result<LinearLayer, LocalError> {
        let layer = self.sub_scope(layer);
        let weight = layer.read_tensor("weight", &[outputs, inputs])?;
        let bias = if layer.has_tensor("bias") { Some(layer.read_tensor("bias", &[outputs])?) } else { None };
        LinearLayer::new(&weight, bias).map_err(|error| layer.tensor_error("weight", &error))
    }

    /// Reads several layers with the same input as one layer, with their outputs side by side. One large product is
    /// faster than several small ones.
    pub(crate) fn read_joined_linears(
        &self,
        layers: &[&str],
        inputs: usize,
        outputs: usize,
    ) -> Result<LinearLayer, LocalError> {
        let read = |name: &str, shape: &[usize]| -> Result<Vec<Tensor>, LocalError> {
            layers.iter().map(|layer| self.sub_scope(layer).read_tensor(name, shape)).collect()
        };
        let wrong = |error: candle_core::Error| self.tensor_error(layers.first().unwrap_or(&""), &error);
        let weight = Tensor::cat(&read("weight", &[outputs, inputs])?, 0).map_err(wrong)?;
        let has_bias = layers.iter().any(|layer| self.sub_scope(layer).has_tensor("bias"));
        let bias = if has_bias { Some(Tensor::cat(&read("bias", &[outputs])?, 0).map_err(wrong)?) } else { None };
        LinearLayer::new(&weight, bias).map_err(wrong)
    }

    /// Reads a layer norm: `weight` and `bias` [size].
    pub(crate) fn read_layer_norm(&self, layer: &str, size: usize, epsilon: f64) -> Result<LayerNorm, LocalError> {
        let layer = self.sub_scope(layer);
        Ok(LayerNorm::new(layer.read_tensor("weight", &[size])?, layer.read_tensor("bias", &[size])?, epsilon))
    }

    /// Reads a root-mean-square norm: `weight` [size].
    pub(crate) fn read_rms_norm(&self, layer: &str, size: usize, epsilon: f64) -> Result<RmsNorm, LocalError> {
        Ok(RmsNorm::new(self.sub_scope(layer).read_tensor("weight", &[size])?, epsilon))
    }

    /// Reads a table that is looked up by ids: `weight` [count, size].
    pub(crate) fn read_embedding(&self, layer: &str, count: usize, size: usize) -> Result<EmbeddingTable, LocalError> {
        Ok(EmbeddingTable::new(self.sub_scope(layer).read_tensor("weight", &[count, size])?))
    }

    /// The error for a failed computation with a tensor.
    pub(crate) fn tensor_error(&self, name: &str, error: &candle_core::Error) -> LocalError {
        LocalError::bad_tensor(&self.weights.path, self.full_name(name), error.to_string())
    }
}

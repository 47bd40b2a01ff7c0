//! Reads the sizes of the backbone, a Swin transformer, from the `backbone_config` of transformers.

use crate::swin::SwinConfig;
use serde::Deserialize;
use serde_json::{Map, Value};

/// `backbone_config` as it is in the file. Missing values get the defaults of transformers.
#[derive(Deserialize)]
#[serde(default)]
struct DinoBackboneConfig {
    model_type: String,
    embed_dim: usize,
    depths: Vec<usize>,
    num_heads: Vec<usize>,
    window_size: usize,
    mlp_ratio: f64,
    patch_size: usize,
    num_channels: usize,
    qkv_bias: bool,
    hidden_act: String,
    use_absolute_embeddings: bool,
    layer_norm_eps: f64,
    out_features: Option<Vec<String>>,
    out_indices: Option<Vec<usize>>,
}

impl Default for DinoBackboneConfig {
    fn default() -> Self {
        let tiny = SwinConfig::for_swin_tiny();
        Self {
            model_type: "swin".to_owned(),
            embed_dim: tiny.width,
            depths: tiny.depths,
            num_heads: tiny.heads,
            window_size: tiny.window,
            mlp_ratio: 4.0,
            patch_size: 4,
            num_channels: 3,
            qkv_bias: true,
            hidden_act: "gelu".to_owned(),
            use_absolute_embeddings: false,
            layer_norm_eps: tiny.epsilon,
            out_features: None,
            out_indices: None,
        }
    }
}

/// Reads and checks the sizes of a Swin transformer from a `backbone_config`.
pub(super) fn swin_config(given: Map<String, Value>) -> Result<SwinConfig, String> {
    let given = given.into_iter().filter(|(_, value)| !value.is_null()).collect();
    let written: DinoBackboneConfig =
        serde_path_to_error::deserialize(Value::Object(given)).map_err(|e| e.to_string())?;
    if written.model_type != "swin" {
        return Err(format!("model_type: {} is not swin", written.model_type));
    }
    let fixed_values = (written.patch_size, written.num_channels, written.qkv_bias, &written.hidden_act[..]);
    if fixed_values != (4, 3, true, "gelu") || written.use_absolute_embeddings {
        return Err("patch_size, num_channels, qkv_bias, hidden_act and use_absolute_embeddings must be 4, 3, true, gelu and false, as in all public checkpoints".to_owned());
    }
    if !(written.mlp_ratio >= 1.0 && written.mlp_ratio.fract() == 0.0 && written.mlp_ratio <= 32.0) {
        return Err(format!("mlp_ratio: {} is not a whole number from 1 to 32", written.mlp_ratio));
    }
    let outputs = output_stages(written.out_indices, written.out_features)?;
    let config = SwinConfig {
        width: written.embed_dim,
        depths: written.depths,
        heads: written.num_heads,
        window: written.window_size,
        widening: written.mlp_ratio as usize,
        outputs,
        epsilon: written.layer_norm_eps,
    };
    config.find_problem().map_or(Ok(config), Err)
}

/// The stages, from 0, from which the model takes outputs. The file has numbers, in which 0 is the input of the first
/// stage and 1 the first stage itself, or names (`stage1`).
fn output_stages(indices: Option<Vec<usize>>, names: Option<Vec<String>>) -> Result<Vec<usize>, String> {
    let from_name = |name: &String| name.strip_prefix("stage").and_then(|number| number.parse().ok());
    let numbers: Vec<Option<usize>> = match (indices, names) {
        (Some(indices), _) => indices.into_iter().map(Some).collect(),
        (None, Some(names)) => names.iter().map(from_name).collect(),
        (None, None) => vec![Some(2), Some(3), Some(4)],
    };
    let stages: Option<Vec<usize>> = numbers.iter().map(|number| (*number)?.checked_sub(1)).collect();
    match stages {
        Some(stages) if !stages.is_empty() && stages.is_sorted_by(|a, b| a < b) => Ok(stages),
        _ => Err("out_indices, out_features: they are not some stages in their order".to_owned()),
    }
}

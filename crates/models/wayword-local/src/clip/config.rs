//! CLIP's `config.json`. Missing values are those that transformers takes.

use crate::{LocalError, json, ops::Activation};
use serde::{Deserialize, de::DeserializeOwned};
use serde_json::{Map, Value};
use std::path::Path;

/// `config.json`, with missing values filled in.
#[derive(Debug)]
pub(super) struct Config {
    pub(super) text: TextConfig,
    pub(super) vision: VisionConfig,
    /// How many numbers a vector has.
    pub(super) projection_dim: usize,
}

#[derive(Debug, Deserialize)]
pub(super) struct TextConfig {
    #[serde(flatten)]
    pub(super) layers: LayersConfig,
    pub(super) vocab_size: usize,
    pub(super) max_position_embeddings: usize,
    pub(super) eos_token_id: u32,
}

#[derive(Debug, Deserialize)]
pub(super) struct VisionConfig {
    #[serde(flatten)]
    pub(super) layers: LayersConfig,
    pub(super) image_size: usize,
    pub(super) patch_size: usize,
}

/// The settings that both towers have.
#[derive(Debug, Deserialize)]
pub(super) struct LayersConfig {
    pub(super) hidden_size: usize,
    pub(super) intermediate_size: usize,
    pub(super) num_hidden_layers: usize,
    pub(super) num_attention_heads: usize,
    pub(super) hidden_act: Activation,
    pub(super) layer_norm_eps: f64,
}

/// `config.json` as it is written.
#[derive(Deserialize)]
struct Written {
    model_type: Option<String>,
    projection_dim: Option<usize>,
    text_config: Option<Map<String, Value>>,
    vision_config: Option<Map<String, Value>>,
    /// In old files. If present, it replaces `text_config` as a whole: values that it lacks are transformers' defaults.
    text_config_dict: Option<Map<String, Value>>,
    /// The same for `vision_config`.
    vision_config_dict: Option<Map<String, Value>>,
}

/// Longest edge of a picture for a model, pixels.
const LONGEST_EDGE: usize = 2048;

impl Config {
    pub(super) fn read(folder: &Path) -> Result<Self, LocalError> {
        let written: Written = json::read(folder, "config.json", "the configuration")?;
        written.complete().map_err(|problem| LocalError::File {
            file: folder.join("config.json"),
            problem,
            hint: "choose a CLIP model, such as hf/openai/clip-vit-base-patch32; if this is one, its file is damaged: delete the folder models--ORG--NAME that holds it, and run `wayword models fetch hf/ORG/NAME`",
        })
    }
}

impl Written {
    fn complete(self) -> Result<Config, String> {
        if let Some(kind) = self.model_type.filter(|kind| kind != "clip") {
            return Err(format!("model_type: {kind} is not clip"));
        }
        let text: TextConfig = overlaid(
            "text_config",
            self.text_config_dict.or(self.text_config),
            serde_json::json!({
                "vocab_size": 49408, "hidden_size": 512, "intermediate_size": 2048, "num_hidden_layers": 12,
                "num_attention_heads": 8, "max_position_embeddings": 77, "hidden_act": "quick_gelu",
                "layer_norm_eps": 1e-5, "eos_token_id": 49407,
            }),
        )?;
        let vision: VisionConfig = overlaid(
            "vision_config",
            self.vision_config_dict.or(self.vision_config),
            serde_json::json!({
                "hidden_size": 768, "intermediate_size": 3072, "num_hidden_layers": 12, "num_attention_heads": 12,
                "image_size": 224, "patch_size": 32, "hidden_act": "quick_gelu", "layer_norm_eps": 1e-5,
            }),
        )?;
        text.layers.check("text_config")?;
        vision.layers.check("vision_config")?;
        let (edge, patch) = (vision.image_size, vision.patch_size);
        if edge == 0 || edge > LONGEST_EDGE || patch == 0 || !edge.is_multiple_of(patch) {
            return Err(format!("vision_config: pictures of {edge} pixels cannot be cut into patches of {patch}"));
        }
        if text.max_position_embeddings == 0 {
            return Err("text_config.max_position_embeddings: it must be at least 1".to_owned());
        }
        Ok(Config { text, vision, projection_dim: self.projection_dim.unwrap_or(512) })
    }
}

impl LayersConfig {
    fn check(&self, part: &str) -> Result<(), String> {
        let (size, heads) = (self.hidden_size, self.num_attention_heads);
        if size == 0 || heads == 0 || !size.is_multiple_of(heads) {
            return Err(format!("{part}.num_attention_heads: {heads} does not divide hidden_size {size}"));
        }
        if self.num_hidden_layers == 0 {
            return Err(format!("{part}.num_hidden_layers: it must be at least 1"));
        }
        Ok(())
    }
}

/// The given values over the defaults.
fn overlaid<T: DeserializeOwned>(part: &str, given: Option<Map<String, Value>>, defaults: Value) -> Result<T, String> {
    let Value::Object(mut all) = defaults else { return Err(format!("{part}: there are no defaults")) };
    all.extend(given.into_iter().flatten().filter(|(_, value)| !value.is_null()));
    serde_path_to_error::deserialize(Value::Object(all)).map_err(|error| format!("{part}: {error}"))
}

//! What BLIP's `config.json` says of its shape, with the values that transformers takes where it says nothing.

use crate::{LocalError, json, ops::Activation};
use serde::Deserialize;
use std::path::Path;

/// `config.json`.
#[derive(Debug, Deserialize)]
pub(super) struct Config {
    model_type: Option<String>,
    #[serde(default)]
    pub(super) text_config: TextConfig,
    #[serde(default)]
    pub(super) vision_config: VisionConfig,
}

/// `vision_config`.
#[derive(Debug, Deserialize)]
#[serde(default)]
pub(super) struct VisionConfig {
    pub(super) hidden_size: usize,
    pub(super) intermediate_size: usize,
    pub(super) num_hidden_layers: usize,
    pub(super) num_attention_heads: usize,
    pub(super) image_size: usize,
    pub(super) patch_size: usize,
    pub(super) hidden_act: Activation,
    pub(super) layer_norm_eps: f64,
}

/// `text_config`.
#[derive(Debug, Deserialize)]
#[serde(default)]
pub(super) struct TextConfig {
    pub(super) vocab_size: usize,
    pub(super) hidden_size: usize,
    pub(super) encoder_hidden_size: usize,
    pub(super) intermediate_size: usize,
    pub(super) num_hidden_layers: usize,
    pub(super) num_attention_heads: usize,
    pub(super) max_position_embeddings: usize,
    pub(super) hidden_act: Activation,
    pub(super) layer_norm_eps: f64,
    pub(super) bos_token_id: u32,
    pub(super) sep_token_id: u32,
}

impl Default for VisionConfig {
    fn default() -> Self {
        Self {
            hidden_size: 768,
            intermediate_size: 3072,
            num_hidden_layers: 12,
            num_attention_heads: 12,
            image_size: 384,
            patch_size: 16,
            hidden_act: Activation::Gelu,
            layer_norm_eps: 1e-5,
        }
    }
}

impl Default for TextConfig {
    fn default() -> Self {
        Self {
            vocab_size: 30524,
            hidden_size: 768,
            encoder_hidden_size: 768,
            intermediate_size: 3072,
            num_hidden_layers: 12,
            num_attention_heads: 8,
            max_position_embeddings: 512,
            hidden_act: Activation::Gelu,
            layer_norm_eps: 1e-12,
            bos_token_id: 30522,
            sep_token_id: 102,
        }
    }
}

impl Config {
    pub(super) fn read(folder: &Path) -> Result<Self, LocalError> {
        let config: Self = json::read(folder, "config.json", "the configuration")?;
        let (text, vision) = (&config.text_config, &config.vision_config);
        let divides = |part: usize, whole: usize| part > 0 && whole % part == 0;
        let problem = if config.model_type.as_deref() != Some("blip") {
            "model_type: it is not blip"
        } else if !divides(vision.num_attention_heads, vision.hidden_size) {
            "vision_config.num_attention_heads: they do not divide hidden_size"
        } else if !divides(text.num_attention_heads, text.hidden_size) {
            "text_config.num_attention_heads: they do not divide hidden_size"
        } else if !divides(vision.patch_size, vision.image_size) {
            "vision_config.patch_size: it does not divide image_size"
        } else {
            return Ok(config);
        };
        Err(LocalError::File {
            file: folder.join("config.json"),
            problem: problem.to_owned(),
            hint: "name a BLIP checkpoint, as Salesforce/blip-vqa-base",
        })
    }
}

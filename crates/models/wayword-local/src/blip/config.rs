//! Reads BLIP's `config.json`. Missing values get the defaults of transformers.

use crate::{LocalError, json, ops::Activation};
use serde::Deserialize;
use std::path::Path;

/// `config.json`, with the names of transformers.
#[derive(Debug, Deserialize)]
pub(super) struct BlipConfig {
    model_type: Option<String>,
    #[serde(default)]
    pub(super) text_config: TextConfig,
    #[serde(default)]
    pub(super) vision_config: VisionConfig,
}

/// `vision_config`: the sizes of the vision model.
#[derive(Debug, Deserialize)]
#[serde(default)]
pub(crate) struct VisionConfig {
    pub(crate) hidden_size: usize,
    pub(crate) intermediate_size: usize,
    pub(crate) num_hidden_layers: usize,
    pub(crate) num_attention_heads: usize,
    pub(crate) image_size: usize,
    pub(crate) patch_size: usize,
    pub(crate) hidden_act: Activation,
    pub(crate) layer_norm_eps: f64,
}

/// `text_config`: the sizes of the text encoder and of the text decoder.
#[derive(Debug, Deserialize)]
#[serde(default)]
pub(super) struct TextConfig {
    pub(super) vocab_size: usize,
    pub(super) hidden_size: usize,
    /// The vision model's `hidden_size`: transformers ignores the file's value here.
    #[serde(skip)]
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

impl BlipConfig {
    pub(super) fn from_folder(folder: &Path) -> Result<Self, LocalError> {
        let mut config: Self = json::read_required(folder, "config.json", "the configuration")?;
        config.text_config.encoder_hidden_size = config.vision_config.hidden_size;
        match config.find_problem() {
            None => Ok(config),
            Some(problem) => Err(LocalError::File {
                file: folder.join("config.json"),
                problem,
                hint: "choose a BLIP checkpoint, such as Salesforce/blip-vqa-base",
            }),
        }
    }

    fn find_problem(&self) -> Option<String> {
        if self.model_type.as_deref() != Some("blip") {
            return Some("model_type: it is not blip".to_owned());
        }
        let text = &self.text_config;
        let sizes = [
            ("text_config.vocab_size", text.vocab_size),
            ("text_config.hidden_size", text.hidden_size),
            ("text_config.intermediate_size", text.intermediate_size),
            ("text_config.max_position_embeddings", text.max_position_embeddings),
        ];
        if let Some(problem) = self.vision_config.find_problem().or_else(|| json::size_problem(&sizes)) {
            return Some(problem);
        }
        let heads = text.num_attention_heads;
        (heads == 0 || !text.hidden_size.is_multiple_of(heads))
            .then(|| "text_config.num_attention_heads: it does not divide hidden_size".to_owned())
    }
}

impl VisionConfig {
    /// The problem with the values, if there is one.
    pub(crate) fn find_problem(&self) -> Option<String> {
        let sizes = [
            ("vision_config.hidden_size", self.hidden_size),
            ("vision_config.intermediate_size", self.intermediate_size),
            ("vision_config.num_attention_heads", self.num_attention_heads),
            ("vision_config.image_size", self.image_size),
            ("vision_config.patch_size", self.patch_size),
        ];
        if let Some(problem) = json::size_problem(&sizes) {
            return Some(problem);
        }
        if !self.hidden_size.is_multiple_of(self.num_attention_heads) {
            return Some("vision_config.num_attention_heads: it does not divide hidden_size".to_owned());
        }
        (!self.image_size.is_multiple_of(self.patch_size))
            .then(|| "vision_config.patch_size: it does not divide image_size".to_owned())
    }
}

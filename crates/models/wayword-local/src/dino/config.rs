//! Reads and checks the `config.json` of the family. Missing values get the defaults of transformers.

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

use super::backbone::swin_config;
use crate::{
    LocalError,
    bert::BertConfig,
    json::{self, size_problem},
    ops::Activation,
    swin::SwinConfig,
};
use serde::Deserialize;
use serde_json::{Map, Value};
use std::path::Path;

/// The most levels of a picture's features; more are refused. A level is a grid of cells; each next level is coarser.
const MAX_FEATURE_LEVELS: usize = 8;

/// The groups of channels of the norm that follows each projection of the backbone's maps.
pub(super) const NORM_GROUP_COUNT: usize = 32;

/// `config.json`, with missing values filled in.
#[derive(Debug)]
pub(super) struct DinoConfig {
    pub(super) family: DinoFamily,
    /// The length of a state.
    pub(super) size: usize,
    /// How many cells become queries, each with a box.
    pub(super) queries: usize,
    /// The levels of a picture's features: those of the backbone, then coarser ones.
    pub(super) levels: usize,
    pub(super) encoder: LayersConfig,
    pub(super) decoder: LayersConfig,
    /// Whether all layers of the decoder have the same head for boxes.
    pub(super) shares_boxes: bool,
    /// Whether all layers of the decoder have the same bias of the scores.
    pub(super) shares_classes: bool,
    /// The most tokens of a prompt.
    pub(super) longest: usize,
    /// The temperature of the sines that encode a position in a picture.
    pub(super) temperature: f32,
    /// Added to variances in norms, so that no division is by 0.
    pub(super) epsilon: f64,
    pub(super) activation: Activation,
    pub(super) text: BertConfig,
    pub(super) backbone: SwinConfig,
}

/// The settings of the encoder's or the decoder's layers.
#[derive(Debug, Clone, Copy)]
pub(super) struct LayersConfig {
    pub(super) count: usize,
    pub(super) heads: usize,
    /// The width between the two layers of a feed-forward network.
    pub(super) inner: usize,
    /// How many places a query looks at, for each level and head.
    pub(super) points: usize,
}

/// The kind of checkpoint. They differ in how a logit is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum DinoFamily {
    /// Grounding DINO: a logit is the dot product of a state and a token.
    Plain,
    /// MM Grounding DINO and LLMDet: the dot product is divided by the root of the state's length, and a bias is added.
    Mm,
}

/// `config.json` as it is in the file.
#[derive(Deserialize)]
#[serde(default)]
struct DinoConfigFile {
    model_type: String,
    d_model: usize,
    num_queries: usize,
    num_feature_levels: usize,
    encoder_layers: usize,
    encoder_attention_heads: usize,
    encoder_ffn_dim: usize,
    encoder_n_points: usize,
    decoder_layers: usize,
    decoder_attention_heads: usize,
    decoder_ffn_dim: usize,
    decoder_n_points: usize,
    decoder_bbox_embed_share: bool,
    decoder_cls_embed_share: bool,
    max_text_len: usize,
    positional_embedding_temperature: f32,
    layer_norm_eps: f64,
    activation_function: Activation,
    position_embedding_type: String,
    two_stage: bool,
    embedding_init_target: bool,
    query_dim: usize,
    text_config: Map<String, Value>,
    backbone_config: Map<String, Value>,
}

impl Default for DinoConfigFile {
    fn default() -> Self {
        Self {
            model_type: String::new(),
            d_model: 256,
            num_queries: 900,
            num_feature_levels: 4,
            encoder_layers: 6,
            encoder_attention_heads: 8,
            encoder_ffn_dim: 2048,
            encoder_n_points: 4,
            decoder_layers: 6,
            decoder_attention_heads: 8,
            decoder_ffn_dim: 2048,
            decoder_n_points: 4,
            decoder_bbox_embed_share: true,
            decoder_cls_embed_share: true,
            max_text_len: 256,
            positional_embedding_temperature: 20.0,
            layer_norm_eps: 1e-5,
            activation_function: Activation::Relu,
            position_embedding_type: "sine".to_owned(),
            two_stage: true,
            embedding_init_target: true,
            query_dim: 4,
            text_config: Map::new(),
            backbone_config: Map::new(),
        }
    }
}

impl DinoConfig {
    pub(super) fn from_folder(folder: &Path) -> Result<Self, LocalError> {
        let written: DinoConfigFile = json::read_required(folder, "config.json", "the configuration")?;
        written.fill_defaults().map_err(|problem| LocalError::File {
            file: folder.join("config.json"),
            problem,
            hint: "choose a model of Grounding DINO's architecture, such as hf/iSEE-Laboratory/llmdet_tiny; if this is one, its file is damaged: delete the folder models--ORG--NAME that holds it, and run `wayword models fetch hf/ORG/NAME`",
        })
    }
}

impl DinoConfigFile {
    fn fill_defaults(self) -> Result<DinoConfig, String> {
        let family = match self.model_type.as_str() {
            "grounding-dino" => DinoFamily::Plain,
            "mm-grounding-dino" => DinoFamily::Mm,
            other => return Err(format!("model_type: {other} is neither grounding-dino nor mm-grounding-dino")),
        };
        self.check_values()?;
        let text = text_config(self.text_config)?;
        let backbone = swin_config(self.backbone_config).map_err(|problem| format!("backbone_config.{problem}"))?;
        if self.num_feature_levels < backbone.outputs.len() {
            let (levels, outputs) = (self.num_feature_levels, backbone.outputs.len());
            return Err(format!("num_feature_levels: {levels} are fewer than the backbone's {outputs}"));
        }
        Ok(DinoConfig {
            family,
            size: self.d_model,
            queries: self.num_queries,
            levels: self.num_feature_levels,
            encoder: LayersConfig {
                count: self.encoder_layers,
                heads: self.encoder_attention_heads,
                inner: self.encoder_ffn_dim,
                points: self.encoder_n_points,
            },
            decoder: LayersConfig {
                count: self.decoder_layers,
                heads: self.decoder_attention_heads,
                inner: self.decoder_ffn_dim,
                points: self.decoder_n_points,
            },
            shares_boxes: self.decoder_bbox_embed_share,
            shares_classes: self.decoder_cls_embed_share,
            longest: self.max_text_len.min(text.max_position_embeddings),
            temperature: self.positional_embedding_temperature,
            epsilon: self.layer_norm_eps,
            activation: self.activation_function,
            text,
            backbone,
        })
    }

    fn check_values(&self) -> Result<(), String> {
        let sizes = [
            ("d_model", self.d_model),
            ("num_queries", self.num_queries),
            ("encoder_layers", self.encoder_layers),
            ("encoder_attention_heads", self.encoder_attention_heads),
            ("encoder_ffn_dim", self.encoder_ffn_dim),
            ("encoder_n_points", self.encoder_n_points),
            ("decoder_layers", self.decoder_layers),
            ("decoder_attention_heads", self.decoder_attention_heads),
            ("decoder_ffn_dim", self.decoder_ffn_dim),
            ("decoder_n_points", self.decoder_n_points),
        ];
        if let Some(problem) = size_problem(&sizes) {
            return Err(problem);
        }
        let size = self.d_model;
        if !size.is_multiple_of(NORM_GROUP_COUNT) {
            return Err(format!("d_model: {size} cannot be cut into {NORM_GROUP_COUNT} groups"));
        }
        // In their part for the text, the encoder's layers have half of the heads and half of the inner width.
        let heads = self.encoder_attention_heads;
        if !heads.is_multiple_of(2) || !size.is_multiple_of(heads) || !self.encoder_ffn_dim.is_multiple_of(heads) {
            let inner = self.encoder_ffn_dim;
            return Err(format!(
                "encoder_attention_heads: {heads} is odd or does not divide d_model {size} and encoder_ffn_dim {inner}"
            ));
        }
        if !size.is_multiple_of(self.decoder_attention_heads) {
            return Err(format!(
                "decoder_attention_heads: {} does not divide d_model {size}",
                self.decoder_attention_heads
            ));
        }
        if !(1..=MAX_FEATURE_LEVELS).contains(&self.num_feature_levels) {
            return Err(format!(
                "num_feature_levels: {} is not from 1 to {MAX_FEATURE_LEVELS}",
                self.num_feature_levels
            ));
        }
        if self.max_text_len < 3 {
            return Err(format!("max_text_len: {} leaves no room for a phrase", self.max_text_len));
        }
        if !(self.positional_embedding_temperature > 0.0 && self.layer_norm_eps > 0.0) {
            return Err("positional_embedding_temperature and layer_norm_eps must be above 0".to_owned());
        }
        match (self.position_embedding_type.as_str(), self.two_stage, self.embedding_init_target, self.query_dim) {
            ("sine", true, true, 4) => Ok(()),
            _ => Err("position_embedding_type, two_stage, embedding_init_target and query_dim must be sine, true, true and 4, as in all public checkpoints".to_owned()),
        }
    }
}

/// Reads `text_config`. Missing values get the defaults of transformers.
fn text_config(given: Map<String, Value>) -> Result<BertConfig, String> {
    let defaults = serde_json::json!({
        "vocab_size": 30522, "hidden_size": 768, "num_hidden_layers": 12, "num_attention_heads": 12,
        "intermediate_size": 3072, "hidden_act": "gelu", "max_position_embeddings": 512,
    });
    let Value::Object(mut all) = defaults else { return Err("text_config: there are no defaults".to_owned()) };
    all.extend(given.into_iter().filter(|(_, value)| !value.is_null()));
    let config: BertConfig =
        serde_path_to_error::deserialize(Value::Object(all)).map_err(|e| format!("text_config: {e}"))?;
    config.check_values().map_err(|problem| format!("text_config.{problem}"))?;
    Ok(config)
}

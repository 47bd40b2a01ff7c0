//! Reads BLIP-2's `config.json`. Missing values get the defaults of transformers.

use crate::{LocalError, blip::VisionConfig as BlipVisionConfig, json, ops::Activation};
use serde::Deserialize;
use std::path::Path;

/// `config.json`, with the names of transformers.
#[derive(Debug, Deserialize)]
pub(super) struct Blip2Config {
    model_type: Option<String>,
    #[serde(default)]
    pub(super) vision_config: VisionConfig,
    #[serde(default)]
    pub(super) qformer_config: QFormerConfig,
    pub(super) text_config: TextConfig,
    #[serde(default = "default_query_count")]
    pub(super) num_query_tokens: usize,
}

/// `vision_config`: the sizes of the vision model.
#[derive(Debug, Deserialize)]
#[serde(default)]
pub(super) struct VisionConfig {
    hidden_size: usize,
    intermediate_size: usize,
    num_hidden_layers: usize,
    num_attention_heads: usize,
    image_size: usize,
    patch_size: usize,
    hidden_act: Activation,
    layer_norm_eps: f64,
}

/// `qformer_config`: the sizes of the Q-Former, which condenses the states of a picture.
#[derive(Debug, Deserialize)]
#[serde(default)]
pub(super) struct QFormerConfig {
    pub(super) hidden_size: usize,
    pub(super) num_hidden_layers: usize,
    pub(super) num_attention_heads: usize,
    pub(super) intermediate_size: usize,
    pub(super) hidden_act: Activation,
    pub(super) layer_norm_eps: f64,
    pub(super) cross_attention_frequency: usize,
    pub(super) encoder_hidden_size: usize,
}

/// `text_config`: the language model and its sizes.
#[derive(Debug, Deserialize)]
#[serde(tag = "model_type", rename_all = "snake_case")]
pub(super) enum TextConfig {
    /// FlanT5.
    T5(T5Config),
    /// OPT.
    Opt(OptConfig),
}

/// T5's `text_config`.
#[derive(Debug, Deserialize)]
#[serde(default)]
pub(super) struct T5Config {
    pub(super) vocab_size: usize,
    pub(super) d_model: usize,
    pub(super) d_kv: usize,
    pub(super) d_ff: usize,
    pub(super) num_layers: usize,
    pub(super) num_decoder_layers: Option<usize>,
    pub(super) num_heads: usize,
    pub(super) relative_attention_num_buckets: usize,
    pub(super) relative_attention_max_distance: usize,
    pub(super) layer_norm_epsilon: f64,
    pub(super) feed_forward_proj: String,
    /// Overrides the activation of `feed_forward_proj`.
    pub(super) dense_act_fn: Option<Activation>,
    pub(super) tie_word_embeddings: bool,
    pub(super) scale_decoder_outputs: Option<bool>,
    pub(super) decoder_start_token_id: u32,
    pub(super) eos_token_id: u32,
}

/// OPT's `text_config`.
#[derive(Debug, Deserialize)]
#[serde(default)]
pub(super) struct OptConfig {
    pub(super) vocab_size: usize,
    pub(super) hidden_size: usize,
    pub(super) num_hidden_layers: usize,
    pub(super) ffn_dim: usize,
    pub(super) max_position_embeddings: usize,
    pub(super) num_attention_heads: usize,
    pub(super) activation_function: Activation,
    pub(super) do_layer_norm_before: bool,
    pub(super) word_embed_proj_dim: Option<usize>,
    pub(super) eos_token_id: u32,
}

fn default_query_count() -> usize {
    32
}

impl Default for VisionConfig {
    fn default() -> Self {
        Self {
            hidden_size: 1408,
            intermediate_size: 6144,
            num_hidden_layers: 39,
            num_attention_heads: 16,
            image_size: 224,
            patch_size: 14,
            hidden_act: Activation::Gelu,
            layer_norm_eps: 1e-6,
        }
    }
}

impl Default for QFormerConfig {
    fn default() -> Self {
        Self {
            hidden_size: 768,
            num_hidden_layers: 12,
            num_attention_heads: 12,
            intermediate_size: 3072,
            hidden_act: Activation::Gelu,
            layer_norm_eps: 1e-12,
            cross_attention_frequency: 2,
            encoder_hidden_size: 1408,
        }
    }
}

impl Default for T5Config {
    fn default() -> Self {
        Self {
            vocab_size: 32128,
            d_model: 512,
            d_kv: 64,
            d_ff: 2048,
            num_layers: 6,
            num_decoder_layers: None,
            num_heads: 8,
            relative_attention_num_buckets: 32,
            relative_attention_max_distance: 128,
            layer_norm_epsilon: 1e-6,
            feed_forward_proj: "relu".to_owned(),
            dense_act_fn: None,
            tie_word_embeddings: true,
            scale_decoder_outputs: None,
            decoder_start_token_id: 0,
            eos_token_id: 1,
        }
    }
}

impl Default for OptConfig {
    fn default() -> Self {
        Self {
            vocab_size: 50272,
            hidden_size: 768,
            num_hidden_layers: 12,
            ffn_dim: 3072,
            max_position_embeddings: 2048,
            num_attention_heads: 12,
            activation_function: Activation::Relu,
            do_layer_norm_before: true,
            word_embed_proj_dim: None,
            eos_token_id: 2,
        }
    }
}

impl VisionConfig {
    /// The same configuration for BLIP's vision model, which has the same architecture.
    pub(super) fn to_blip_config(&self) -> BlipVisionConfig {
        BlipVisionConfig {
            hidden_size: self.hidden_size,
            intermediate_size: self.intermediate_size,
            num_hidden_layers: self.num_hidden_layers,
            num_attention_heads: self.num_attention_heads,
            image_size: self.image_size,
            patch_size: self.patch_size,
            hidden_act: self.hidden_act,
            layer_norm_eps: self.layer_norm_eps,
        }
    }
}

impl TextConfig {
    /// The number of numbers in a token's state.
    pub(super) fn state_width(&self) -> usize {
        match self {
            Self::T5(text) => text.d_model,
            Self::Opt(text) => text.hidden_size,
        }
    }

    /// The problem with the values, if there is one.
    fn find_problem(&self) -> Option<String> {
        let (sizes, problem) = match self {
            Self::T5(text) => {
                let sizes = vec![
                    ("text_config.vocab_size", text.vocab_size),
                    ("text_config.d_model", text.d_model),
                    ("text_config.d_kv", text.d_kv),
                    ("text_config.d_ff", text.d_ff),
                    ("text_config.num_heads", text.num_heads),
                    ("text_config.relative_attention_num_buckets", text.relative_attention_num_buckets),
                ];
                let buckets = text.relative_attention_num_buckets;
                let problem = if text.feed_forward_proj != "gated-gelu" {
                    Some("text_config.feed_forward_proj: only FlanT5's gated-gelu is supported")
                } else if buckets < 4 || text.relative_attention_max_distance <= buckets {
                    Some(
                        "text_config: relative_attention_num_buckets must be from 4 to below relative_attention_max_distance",
                    )
                } else {
                    None
                };
                (sizes, problem)
            }
            Self::Opt(text) => {
                let sizes = vec![
                    ("text_config.vocab_size", text.vocab_size),
                    ("text_config.hidden_size", text.hidden_size),
                    ("text_config.ffn_dim", text.ffn_dim),
                    ("text_config.max_position_embeddings", text.max_position_embeddings),
                ];
                let projects = text.word_embed_proj_dim.is_some_and(|width| width != text.hidden_size);
                let problem = if !divides_evenly(text.num_attention_heads, text.hidden_size) {
                    Some("text_config.num_attention_heads: it does not divide hidden_size")
                } else if !text.do_layer_norm_before || projects {
                    Some("text_config: the architecture of OPT-350m is not supported")
                } else {
                    None
                };
                (sizes, problem)
            }
        };
        json::size_problem(&sizes).or(problem.map(str::to_owned))
    }
}

fn divides_evenly(part: usize, whole: usize) -> bool {
    part > 0 && whole.is_multiple_of(part)
}

impl Blip2Config {
    pub(super) fn from_folder(folder: &Path) -> Result<Self, LocalError> {
        let config: Self = json::read_required(folder, "config.json", "the configuration")?;
        match config.find_problem() {
            None => Ok(config),
            Some(problem) => Err(LocalError::File {
                file: folder.join("config.json"),
                problem,
                hint: "choose a BLIP-2 checkpoint, such as Salesforce/blip2-flan-t5-xl or Salesforce/blip2-opt-2.7b",
            }),
        }
    }

    fn find_problem(&self) -> Option<String> {
        if self.model_type.as_deref() != Some("blip-2") {
            return Some("model_type: it is not blip-2".to_owned());
        }
        let queries = &self.qformer_config;
        let sizes = [
            ("num_query_tokens", self.num_query_tokens),
            ("qformer_config.hidden_size", queries.hidden_size),
            ("qformer_config.intermediate_size", queries.intermediate_size),
            ("qformer_config.encoder_hidden_size", queries.encoder_hidden_size),
            ("qformer_config.cross_attention_frequency", queries.cross_attention_frequency),
        ];
        if !divides_evenly(queries.num_attention_heads, queries.hidden_size) {
            return Some("qformer_config.num_attention_heads: it does not divide hidden_size".to_owned());
        }
        self.vision_config
            .to_blip_config()
            .find_problem()
            .or_else(|| json::size_problem(&sizes))
            .or_else(|| self.text_config.find_problem())
    }
}

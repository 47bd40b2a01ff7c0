//! Reads and checks the configuration files of a BERT and of a sentence encoder.

use crate::{LocalError, json, json::size_problem, ops::Activation};
use serde::Deserialize;
use std::path::Path;

/// `config.json`, with the names of transformers.
#[derive(Debug, Deserialize)]
pub(crate) struct BertConfig {
    pub(crate) vocab_size: usize,
    pub(crate) hidden_size: usize,
    pub(crate) num_hidden_layers: usize,
    pub(crate) num_attention_heads: usize,
    pub(crate) intermediate_size: usize,
    pub(crate) hidden_act: Activation,
    pub(crate) max_position_embeddings: usize,
    #[serde(default = "default_type_vocab_size")]
    pub(crate) type_vocab_size: usize,
    #[serde(default = "default_norm_epsilon")]
    pub(crate) layer_norm_eps: f64,
    model_type: Option<String>,
}

/// The sizes of an encoder that is a BERT in all other respects.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BertSizes {
    pub(crate) vocab_size: usize,
    pub(crate) hidden_size: usize,
    pub(crate) num_hidden_layers: usize,
    pub(crate) num_attention_heads: usize,
    pub(crate) intermediate_size: usize,
    pub(crate) max_position_embeddings: usize,
    pub(crate) type_vocab_size: usize,
}

/// The most layers that a configuration may have; more are refused. BERT-large has 24.
const MAX_LAYERS: usize = 64;

impl BertSizes {
    /// The problem with the sizes, if there is one.
    pub(crate) fn find_problem(&self) -> Option<String> {
        let (heads, layers) = (self.num_attention_heads, self.num_hidden_layers);
        let sizes = [
            ("vocab_size", self.vocab_size),
            ("hidden_size", self.hidden_size),
            ("intermediate_size", self.intermediate_size),
            ("max_position_embeddings", self.max_position_embeddings),
            ("type_vocab_size", self.type_vocab_size),
        ];
        if let Some(problem) = size_problem(&sizes) {
            return Some(problem);
        }
        if heads == 0 || !self.hidden_size.is_multiple_of(heads) {
            return Some(format!("num_attention_heads: {heads} does not divide hidden_size {}", self.hidden_size));
        }
        (!(1..=MAX_LAYERS).contains(&layers))
            .then(|| format!("num_hidden_layers: {layers} is not from 1 to {MAX_LAYERS}"))
    }
}

/// `sentence_bert_config.json`: the limit that a sentence encoder sets below that of its BERT.
#[derive(Debug, Deserialize)]
struct LengthConfig {
    max_seq_length: Option<usize>,
}

/// `tokenizer_config.json`: newer encoders have their limit here.
#[derive(Debug, Deserialize)]
struct TokenizerLength {
    model_max_length: Option<f64>,
}

fn default_type_vocab_size() -> usize {
    2
}

fn default_norm_epsilon() -> f64 {
    1e-12
}

impl BertConfig {
    pub(super) fn from_folder(folder: &Path) -> Result<Self, LocalError> {
        let config: Self = json::read_required(folder, "config.json", "the configuration")?;
        let wrong = |problem: String| LocalError::File {
            file: folder.join("config.json"),
            problem,
            hint: "choose a sentence encoder with BERT's architecture, such as sentence-transformers/all-MiniLM-L6-v2",
        };
        config.check_values().map_err(wrong)?;
        Ok(config)
    }

    /// Checks the values that the computation relies on.
    pub(crate) fn check_values(&self) -> Result<(), String> {
        if let Some(kind) = self.model_type.as_deref().filter(|kind| *kind != "bert") {
            return Err(format!("model_type: {kind} is not bert"));
        }
        let (size, heads) = (self.hidden_size, self.num_attention_heads);
        if heads == 0 || !size.is_multiple_of(heads) {
            return Err(format!("num_attention_heads: {heads} does not divide hidden_size {size}"));
        }
        Ok(())
    }

    /// The configuration of an encoder of these sizes, with BERT's activation and norms.
    pub(crate) fn for_sizes(sizes: &BertSizes) -> Self {
        Self {
            vocab_size: sizes.vocab_size,
            hidden_size: sizes.hidden_size,
            num_hidden_layers: sizes.num_hidden_layers,
            num_attention_heads: sizes.num_attention_heads,
            intermediate_size: sizes.intermediate_size,
            hidden_act: Activation::Gelu,
            max_position_embeddings: sizes.max_position_embeddings,
            type_vocab_size: sizes.type_vocab_size,
            layer_norm_eps: default_norm_epsilon(),
            model_type: None,
        }
    }

    pub(crate) fn hidden_size(&self) -> usize {
        self.hidden_size
    }

    pub(crate) fn vocab_size(&self) -> usize {
        self.vocab_size
    }

    /// The most tokens for which the model has positions.
    pub(crate) fn max_positions(&self) -> usize {
        self.max_position_embeddings
    }

    /// The most tokens of a text: the model's limit, or the lower one that the sentence encoder sets, or else its tokenizer.
    pub(super) fn max_text_tokens(&self, folder: &Path) -> Result<usize, LocalError> {
        let config: Option<LengthConfig> = json::read_if_there(folder, "sentence_bert_config.json")?;
        let mut limit = config.and_then(|config| config.max_seq_length);
        if limit.is_none() {
            let config: Option<TokenizerLength> = json::read_if_there(folder, "tokenizer_config.json")?;
            // A tokenizer without a limit has 1e30.
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "too large ones become the largest"
            )]
            let length = |length: f64| (length >= 1.0).then_some(length as usize);
            limit = config.and_then(|config| config.model_max_length).and_then(length);
        }
        Ok(limit.unwrap_or(usize::MAX).min(self.max_position_embeddings))
    }
}

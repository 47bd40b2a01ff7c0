//! The sizes of a GLIP. The original checkpoints have no configuration, so the sizes of GLIP-T are built in.

use crate::{LocalError, bert, json, json::size_problem, swin::SwinConfig};
use serde::Deserialize;
use std::path::Path;

/// The sizes of a model.
pub(super) struct GlipConfig {
    pub(super) swin: SwinConfig,
    pub(super) text: bert::BertConfig,
    pub(super) head: HeadConfig,
}

/// The sizes of the head.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct HeadConfig {
    /// Channels of the features.
    pub(super) width: usize,
    /// Groups of channels of the norms.
    pub(super) groups: usize,
    /// Rounds of the head, each with a fusion, a text layer and convolutions.
    pub(super) rounds: usize,
    pub(super) fusion_heads: usize,
    /// Width of a head of the fusion.
    pub(super) fusion_width: usize,
}

/// `config.json`, which only small models for tests have.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GlipConfigFile {
    model_type: String,
    swin: GlipSwinConfig,
    text: bert::BertSizes,
    head: HeadConfig,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GlipSwinConfig {
    width: usize,
    depths: Vec<usize>,
    heads: Vec<usize>,
    window: usize,
}

/// The most rounds of the head that a configuration may have; more are refused. GLIP-L has 8.
const MAX_HEAD_ROUNDS: usize = 16;

impl GlipConfig {
    /// The sizes from `config.json` of a folder, or GLIP-T's.
    pub(super) fn from_folder(folder: &Path) -> Result<Self, LocalError> {
        let Some(written) = json::read_if_there::<GlipConfigFile>(folder, "config.json")? else {
            return Ok(Self::for_glip_tiny());
        };
        written.into_config().map_err(|problem| LocalError::File {
            file: folder.join("config.json"),
            problem,
            hint: "the original checkpoints of GLIP come without this file: take it away, or correct it",
        })
    }

    /// The sizes of GLIP-T and of its variants A, B and C.
    fn for_glip_tiny() -> Self {
        let sizes = bert::BertSizes {
            vocab_size: 30522,
            hidden_size: 768,
            num_hidden_layers: 12,
            num_attention_heads: 12,
            intermediate_size: 3072,
            max_position_embeddings: 512,
            type_vocab_size: 2,
        };
        let head = HeadConfig { width: 256, groups: 16, rounds: 6, fusion_heads: 8, fusion_width: 256 };
        Self { swin: SwinConfig::for_swin_tiny(), text: bert::BertConfig::for_sizes(&sizes), head }
    }
}

impl GlipConfigFile {
    fn into_config(self) -> Result<GlipConfig, String> {
        if self.model_type != "glip" {
            return Err(format!("model_type: {} is not glip", self.model_type));
        }
        let GlipSwinConfig { width, depths, heads, window } = self.swin;
        let swin = SwinConfig { width, depths, heads, window, ..SwinConfig::for_swin_tiny() };
        if swin.depths.len() != 4 {
            return Err("swin.depths: there must be 4 stages".to_owned());
        }
        if let Some(problem) = swin.find_problem() {
            return Err(format!("swin.{problem}"));
        }
        if let Some(problem) = self.text.find_problem() {
            return Err(format!("text.{problem}"));
        }
        let head = &self.head;
        let sizes = [
            ("head.width", head.width),
            ("head.groups", head.groups),
            ("head.fusion_heads", head.fusion_heads),
            ("head.fusion_width", head.fusion_width),
        ];
        if let Some(problem) = size_problem(&sizes) {
            return Err(problem);
        }
        if !head.width.is_multiple_of(head.groups) || !head.width.is_multiple_of(4) {
            return Err(format!("head.groups: {} and 4 do not divide the width {}", head.groups, head.width));
        }
        if !(1..=MAX_HEAD_ROUNDS).contains(&head.rounds) {
            return Err(format!("head.rounds: {} is not from 1 to {MAX_HEAD_ROUNDS}", head.rounds));
        }
        Ok(GlipConfig { swin, text: bert::BertConfig::for_sizes(&self.text), head: self.head })
    }
}

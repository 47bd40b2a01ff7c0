//! The sizes of a Swin transformer, and the names of its tensors.

use crate::json::size_problem;

/// The sizes of a Swin transformer.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SwinConfig {
    /// Channels of the first stage. Each further stage has twice as many.
    pub(crate) width: usize,
    /// Blocks of each stage.
    pub(crate) depths: Vec<usize>,
    /// Attention heads of each stage.
    pub(crate) heads: Vec<usize>,
    /// Edge of a window, positions.
    pub(crate) window: usize,
    /// The width between the two layers of a block, as a multiple of the block's own.
    pub(crate) widening: usize,
    /// The stages, counted from 0, that give an output of the backbone. Each of these outputs has its own norm.
    pub(crate) outputs: Vec<usize>,
    /// Added to variances, so that no division is by 0.
    pub(crate) epsilon: f64,
}

/// The most stages, and the most blocks of a stage; more are refused. Published models have 4 and 18.
const MAX_STAGES: usize = 8;
const MAX_STAGE_BLOCKS: usize = 64;

/// The largest edge of a window, positions, and the largest widening; larger ones are refused. Published models have
/// windows of 7 and 12.
const MAX_WINDOW_EDGE: usize = 32;

impl SwinConfig {
    /// Swin-T: 28 million parameters, with the outputs at strides 8, 16 and 32.
    pub(crate) fn for_swin_tiny() -> Self {
        Self {
            width: 96,
            depths: vec![2, 2, 6, 2],
            heads: vec![3, 6, 12, 24],
            window: 7,
            widening: 4,
            outputs: vec![1, 2, 3],
            epsilon: 1e-5,
        }
    }

    /// Channels of a stage.
    pub(crate) fn stage_width(&self, stage: usize) -> usize {
        self.width << stage
    }

    /// The problem with the sizes, if there is one. Sizes without a problem are safe to compute with.
    pub(crate) fn find_problem(&self) -> Option<String> {
        let sizes = [("width", self.width), ("window", self.window), ("widening", self.widening)];
        if let Some(problem) = size_problem(&sizes) {
            return Some(problem);
        }
        let stages = self.depths.len();
        if stages == 0 || stages > MAX_STAGES || self.heads.len() != stages {
            return Some(format!(
                "depths and heads: {stages} and {} stages are not 1 to {MAX_STAGES}",
                self.heads.len()
            ));
        }
        if self.window > MAX_WINDOW_EDGE || self.widening > MAX_WINDOW_EDGE {
            return Some(format!(
                "window, widening: {} and {} are not 1 to {MAX_WINDOW_EDGE}",
                self.window, self.widening
            ));
        }
        if let Some(depth) = self.depths.iter().find(|depth| !(1..=MAX_STAGE_BLOCKS).contains(*depth)) {
            return Some(format!("depths: {depth} is not from 1 to {MAX_STAGE_BLOCKS}"));
        }
        let uneven =
            |(stage, heads): &(usize, &usize)| **heads == 0 || !self.stage_width(*stage).is_multiple_of(**heads);
        if let Some((stage, heads)) = self.heads.iter().enumerate().find(uneven) {
            return Some(format!(
                "heads: {heads} does not divide the width {} of stage {stage}",
                self.stage_width(stage)
            ));
        }
        let outside = self.outputs.iter().find(|output| **output >= stages);
        outside.map(|output| format!("outputs: there is no stage {output}"))
    }
}

/// The names of a backbone's tensors within its part of a checkpoint.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SwinTensorNames {
    pub(crate) patch: &'static str,
    pub(crate) patch_norm: &'static str,
    pub(crate) stages: &'static str,
    /// The norm of a stage's output, by the stage from 0.
    pub(crate) out_norm: fn(usize) -> String,
    /// The norm before attention.
    pub(super) attention_norm: &'static str,
    /// Queries, keys and values: one layer or three.
    pub(super) qkv: &'static [&'static str],
    /// The layer behind the attention.
    pub(super) mixed: &'static str,
    /// The table of biases for the distance between two places.
    pub(super) positions: &'static str,
    /// The norm before the two linear layers.
    pub(super) feed_forward_norm: &'static str,
    pub(super) wide: &'static str,
    pub(super) narrow: &'static str,
}

impl SwinTensorNames {
    /// The names of the original implementation, which GLIP's checkpoints have.
    pub(crate) const ORIGINAL: Self = Self {
        patch: "patch_embed.proj",
        patch_norm: "patch_embed.norm",
        stages: "layers",
        out_norm: |stage| format!("norm{stage}"),
        attention_norm: "norm1",
        qkv: &["attn.qkv"],
        mixed: "attn.proj",
        positions: "attn.relative_position_bias_table",
        feed_forward_norm: "norm2",
        wide: "mlp.fc1",
        narrow: "mlp.fc2",
    };

    /// The names of transformers' checkpoints.
    pub(crate) const TRANSFORMERS: Self = Self {
        patch: "embeddings.patch_embeddings.projection",
        patch_norm: "embeddings.norm",
        stages: "encoder.layers",
        out_norm: |stage| format!("hidden_states_norms.stage{}", stage + 1),
        attention_norm: "layernorm_before",
        qkv: &["attention.self.query", "attention.self.key", "attention.self.value"],
        mixed: "attention.output.dense",
        positions: "attention.self.relative_position_bias_table",
        feed_forward_norm: "layernorm_after",
        wide: "intermediate.dense",
        narrow: "output.dense",
    };
}

//! The sizes of a language model, as the metadata of its file gives them.

use super::file::GgufFile;
use crate::LocalError;

/// Longest conversation, tokens: more would take minutes on a processor and a table of positions for each.
const LONGEST_CONTEXT: usize = 32 << 10;

/// Which kind of model a file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Architecture {
    Llama,
    Qwen2,
    Qwen3,
}

/// What has to be known before the weights are read.
#[derive(Debug, Clone)]
pub(super) struct Sizes {
    pub(super) architecture: Architecture,
    pub(super) blocks: usize,
    /// Numbers of a token between the blocks.
    pub(super) width: usize,
    /// Numbers of a token inside the feed-forward part.
    pub(super) inner: usize,
    pub(super) heads: usize,
    /// Heads of keys and values, each for as many heads of queries.
    pub(super) key_heads: usize,
    /// Numbers of a head.
    pub(super) head: usize,
    pub(super) vocabulary: usize,
    /// Longest conversation, tokens.
    pub(super) context: usize,
    pub(super) epsilon: f64,
    /// The base of the angles by which a position turns queries and keys.
    pub(super) base: f64,
    /// By what positions are divided.
    pub(super) stretch: f64,
}

impl Architecture {
    fn read(file: &GgufFile) -> Result<(Self, &str), LocalError> {
        let name = file.text("general.architecture")?.unwrap_or("(none)");
        let architecture = match name {
            "llama" => Self::Llama,
            "qwen2" => Self::Qwen2,
            "qwen3" => Self::Qwen3,
            other => {
                return Err(
                    file.wrong(format!("general.architecture: {other} is not known, only llama, qwen2 and qwen3"))
                );
            }
        };
        Ok((architecture, name))
    }
}

impl Sizes {
    /// Reads them, each within bounds and fitting the others.
    ///
    /// # Errors
    /// When one is missing, or is none.
    pub(super) fn read(file: &GgufFile) -> Result<Self, LocalError> {
        let (architecture, name) = Architecture::read(file)?;
        let key = |rest: &str| format!("{name}.{rest}");
        let heads = file.size(&key("attention.head_count"), 1 << 10)?;
        let key_heads = file.whole(&key("attention.head_count_kv"), 1, heads)?.unwrap_or(heads);
        let width = file.size(&key("embedding_length"), 1 << 16)?;
        let head = file.whole(&key("attention.key_length"), 2, 1 << 10)?.unwrap_or(width / heads);
        let context = file.size(&key("context_length"), usize::MAX)?.min(LONGEST_CONTEXT);
        let sizes = Self {
            architecture,
            blocks: file.size(&key("block_count"), 1 << 9)?,
            width,
            inner: file.size(&key("feed_forward_length"), 1 << 20)?,
            heads,
            key_heads,
            head,
            vocabulary: file.shape("token_embd.weight").and_then(|shape| shape.first().copied()).unwrap_or_default(),
            context,
            epsilon: file.real(&key("attention.layer_norm_rms_epsilon"))?.unwrap_or(1e-6),
            base: file.real(&key("rope.freq_base"))?.unwrap_or(10_000.0),
            stretch: stretch(file, &key("rope.scaling"))?,
        };
        sizes.check(file, &key)?;
        Ok(sizes)
    }

    fn check(&self, file: &GgufFile, key: &impl Fn(&str) -> String) -> Result<(), LocalError> {
        let wrong = |field: &str, problem: String| Err(file.wrong(format!("{}: {problem}", key(field))));
        if !self.heads.is_multiple_of(self.key_heads) {
            return wrong("attention.head_count_kv", format!("{} heads do not share {}", self.heads, self.key_heads));
        }
        if self.head < 2 || !self.head.is_multiple_of(2) {
            return wrong("attention.head_count", format!("heads of {} numbers cannot be turned", self.head));
        }
        for same in ["attention.value_length", "rope.dimension_count"] {
            if file.whole(&key(same), 0, usize::MAX)?.is_some_and(|size| size != self.head) {
                return wrong(same, format!("only {}, a whole head, is known", self.head));
            }
        }
        if file.whole(&key("expert_count"), 0, usize::MAX)?.is_some_and(|experts| experts > 0) {
            return wrong("expert_count", "mixtures of experts are not known".to_owned());
        }
        Ok(())
    }
}

/// By what positions are divided; Llama 3's own way is in the tensor `rope_freqs.weight`.
fn stretch(file: &GgufFile, key: &str) -> Result<f64, LocalError> {
    let kind = format!("{key}.type");
    match file.text(&kind)? {
        None | Some("none") => Ok(1.0),
        Some("linear") => Ok(file.real(&format!("{key}.factor"))?.unwrap_or(1.0)),
        Some(other) => Err(file.wrong(format!("{kind}: {other} is not known, only none and linear"))),
    }
}

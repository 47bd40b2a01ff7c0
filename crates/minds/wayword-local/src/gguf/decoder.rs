//! The model: Llama's decoder, as Qwen2 (biases) and Qwen3 (norms of queries and keys) vary it.
//!
//! candle-transformers has all three, each with a fault that thousands of calls meet: they keep a mask for every length of prompt
//! that ever was, Qwen3's turns positions in 16 bits where the file does not say otherwise, and Llama's leaves out the stretched
//! positions of Llama 3. Products of a few tokens with quantised weights are candle's: on the processor they round what they multiply to
//! 8 bits, as llama.cpp does.

use super::{
    file::GgufFile,
    positions::{Positions, Turn},
    product::Product,
    sizes::{Architecture, Sizes},
};
use crate::{
    LocalError,
    ops::{Activation, Attention, RmsNorm, causal},
};
use candle_core::{Device, Tensor, quantized::QTensor};
use candle_nn::kv_cache::KvCache;
use std::sync::Arc;

/// So many tokens of a prompt are read at once: their scores would else take memory with the square of its length.
const AT_ONCE: usize = 512;
/// By so many tokens the memory of a conversation grows.
const GROWS_BY: usize = 256;

/// The weights.
pub(super) struct Decoder {
    embedding: Arc<QTensor>,
    blocks: Vec<Block>,
    norm: RmsNorm,
    head: Product,
    positions: Positions,
    device: Device,
}

/// What is kept of a conversation: keys and values of each block.
pub(super) struct Conversation {
    blocks: Vec<KvCache>,
    /// How many tokens were read.
    pub(super) length: usize,
}

struct Block {
    before_attention: RmsNorm,
    query: Projection,
    key: Projection,
    value: Projection,
    out: Product,
    /// Of queries and of keys, head by head.
    norms: Option<(RmsNorm, RmsNorm)>,
    before_inner: RmsNorm,
    gate: Product,
    up: Product,
    down: Product,
    heads: usize,
    key_heads: usize,
    head: usize,
}

/// A product, and a bias where the model has one.
struct Projection {
    weight: Product,
    bias: Option<Tensor>,
}

impl Decoder {
    /// Reads the weights.
    ///
    /// # Errors
    /// When a tensor is missing, cut off, or of another shape.
    pub(super) fn load(file: &GgufFile, sizes: &Sizes, device: &Device) -> Result<Self, LocalError> {
        let shape = [sizes.vocabulary, sizes.width];
        let embedding = Arc::new(file.tensor("token_embd.weight", &shape, device)?);
        let head = if file.shape("output.weight").is_some() {
            Product::load(file, "output.weight", &shape, device)?
        } else {
            Product::of(file, "token_embd.weight", Arc::clone(&embedding))?
        };
        let blocks = (0..sizes.blocks).map(|at| Block::load(file, at, sizes, device));
        Ok(Self {
            embedding,
            blocks: blocks.collect::<Result<_, _>>()?,
            norm: norm(file, "output_norm.weight", sizes.width, sizes, device)?,
            head,
            positions: Positions::load(file, sizes, device)?,
            device: device.clone(),
        })
    }

    /// A conversation without a word.
    pub(super) fn begin(&self) -> Conversation {
        Conversation { blocks: vec![KvCache::new(1, GROWS_BY); self.blocks.len()], length: 0 }
    }

    /// Reads on in a conversation: a score for each token that could come next.
    pub(super) fn read(&self, ids: &[u32], conversation: &mut Conversation) -> candle_core::Result<Vec<f32>> {
        let mut last = None;
        for ids in ids.chunks(AT_ONCE) {
            last = Some(self.read_some(ids, conversation)?);
        }
        let Some(last) = last else { candle_core::bail!("there is nothing to read") };
        self.head.times(&self.norm.of(&last)?)?.flatten_all()?.to_vec1()
    }

    /// What the blocks make of the last of some tokens, [1, width].
    fn read_some(&self, ids: &[u32], conversation: &mut Conversation) -> candle_core::Result<Tensor> {
        let (count, from) = (ids.len(), conversation.length);
        let mut x = self.embedding.embedding(&Tensor::new(ids, &self.device)?)?.unsqueeze(0)?;
        let mask = if count > 1 { Some(causal(count, from + count, &self.device)?) } else { None };
        for (block, kept) in self.blocks.iter().zip(&mut conversation.blocks) {
            x = block.of(&x, mask.as_ref(), kept, &self.positions.at(from, count)?)?;
        }
        conversation.length += count;
        x.squeeze(0)?.narrow(0, count - 1, 1)
    }
}

impl Block {
    fn load(file: &GgufFile, at: usize, sizes: &Sizes, device: &Device) -> Result<Self, LocalError> {
        let &Sizes { width, inner, heads, key_heads, head, architecture, .. } = sizes;
        let name = |rest: &str| format!("blk.{at}.{rest}");
        let product = |rest: &str, rows, columns| Product::load(file, &name(rest), &[rows, columns], device);
        let norm = |rest: &str, size| norm(file, &name(rest), size, sizes, device);
        let projection = |rest: &str, rows: usize| {
            let bias = name(&format!("{rest}.bias"));
            let biased = architecture == Architecture::Qwen2 || file.shape(&bias).is_some();
            let bias = if biased { Some(file.wide(&bias, &[rows], device)?) } else { None };
            Ok::<_, LocalError>(Projection { weight: product(&format!("{rest}.weight"), rows, width)?, bias })
        };
        let norms = if architecture == Architecture::Qwen3 {
            Some((norm("attn_q_norm.weight", head)?, norm("attn_k_norm.weight", head)?))
        } else {
            None
        };
        Ok(Self {
            before_attention: norm("attn_norm.weight", width)?,
            query: projection("attn_q", heads * head)?,
            key: projection("attn_k", key_heads * head)?,
            value: projection("attn_v", key_heads * head)?,
            out: product("attn_output.weight", width, heads * head)?,
            norms,
            before_inner: norm("ffn_norm.weight", width)?,
            gate: product("ffn_gate.weight", inner, width)?,
            up: product("ffn_up.weight", inner, width)?,
            down: product("ffn_down.weight", width, inner)?,
            heads,
            key_heads,
            head,
        })
    }

    /// Of x [1, count, width].
    fn of(&self, x: &Tensor, mask: Option<&Tensor>, kept: &mut KvCache, turn: &Turn) -> candle_core::Result<Tensor> {
        let x = (x + self.attention(&self.before_attention.of(x)?, mask, kept, turn)?)?;
        let inner = self.before_inner.of(&x)?;
        let inner = (Activation::Silu.of(&self.gate.times(&inner)?)? * self.up.times(&inner)?)?;
        x + self.down.times(&inner)?
    }

    fn attention(
        &self,
        x: &Tensor,
        mask: Option<&Tensor>,
        kept: &mut KvCache,
        turn: &Turn,
    ) -> candle_core::Result<Tensor> {
        let count = x.dim(1)?;
        let (mut query, mut key) = (self.query.of(x)?, self.key.of(x)?);
        query = query.reshape((1, count, self.heads, self.head))?;
        key = key.reshape((1, count, self.key_heads, self.head))?;
        if let Some((queries, keys)) = &self.norms {
            (query, key) = (queries.of(&query)?, keys.of(&key)?);
        }
        let key = turn.of(&key)?.flatten_from(2)?;
        let (keys, values) = kept.append(&key.contiguous()?, &self.value.of(x)?.contiguous()?)?;
        // Heads that share keys are laid below each other, as if they were more queries of one head.
        let shared = self.heads / self.key_heads;
        let query = turn.of(&query)?.reshape((count, self.key_heads, shared, self.head))?;
        let query = query.permute((2, 0, 1, 3))?.reshape((1, shared * count, self.key_heads * self.head))?;
        let bias = mask.map(|mask| mask.repeat((shared, 1))).transpose()?;
        let scale = 1.0 / (self.head as f32).sqrt();
        let mixed = Attention { heads: self.key_heads, scale, bias: bias.as_ref() }.of(&query, &keys, &values)?;
        let mixed = mixed.reshape((shared, count, self.key_heads, self.head))?.permute((1, 2, 0, 3))?;
        self.out.times(&mixed.reshape((1, count, self.heads * self.head))?)
    }
}

impl Projection {
    fn of(&self, x: &Tensor) -> candle_core::Result<Tensor> {
        let y = self.weight.times(x)?;
        match &self.bias {
            None => Ok(y),
            Some(bias) => y.broadcast_add(bias),
        }
    }
}

fn norm(file: &GgufFile, name: &str, size: usize, sizes: &Sizes, device: &Device) -> Result<RmsNorm, LocalError> {
    Ok(RmsNorm::new(file.wide(name, &[size], device)?, sizes.epsilon))
}

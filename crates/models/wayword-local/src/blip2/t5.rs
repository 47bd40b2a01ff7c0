//! The language model FlanT5 (arXiv 1910.10683, 2210.11416): an encoder reads picture and prompt, and a decoder writes
//! the answer.
//!
//! T5 has no position embeddings. Instead the distance between two tokens adds a learned number to their attention
//! score. Far distances share such numbers in buckets: 5 has its own, while 90 and 100 may have the same.

use super::config::T5Config;
use crate::{
    LocalError,
    greedy::greedy,
    ops::{Activation, Attention, Embedding, Linear, Past, RmsNorm, causal},
    weights::Scope,
};
use candle_core::{Result, Tensor};

/// A T5 with gated layers: the product of two linear layers goes through a third one.
pub(super) struct T5 {
    words: Embedding,
    encoder: Stack,
    decoder: Stack,
    head: Linear,
    /// The factor for the decoder's states.
    scale: Option<f64>,
    begin: u32,
    end: u32,
}

struct Stack {
    blocks: Vec<Block>,
    norm: RmsNorm,
    distances: Distances,
}

/// The numbers [buckets, heads] that the distance between two tokens adds to their score, by bucket and head.
struct Distances {
    table: Embedding,
    buckets: usize,
    farthest: usize,
    both_ways: bool,
}

struct Block {
    norm: RmsNorm,
    qkv: Linear,
    mixed: Linear,
    cross: Option<Cross>,
    wide_norm: RmsNorm,
    gate: Linear,
    wide: Linear,
    narrow: Linear,
    heads: usize,
    activation: Activation,
}

/// Attention to the encoder's states.
struct Cross {
    norm: RmsNorm,
    query: Linear,
    keys_values: Linear,
    mixed: Linear,
}

/// The keys and values of the encoder's states, block by block.
type Attended = Vec<(Tensor, Tensor)>;

impl T5 {
    pub(super) fn load(weights: &Scope<'_>, config: &T5Config) -> std::result::Result<Self, LocalError> {
        let (size, count) = (config.d_model, config.vocab_size);
        // Checkpoints leave out tensors that are tied to another one.
        let words = if weights.has("shared.weight") { "shared" } else { "encoder.embed_tokens" };
        let head = if weights.has("lm_head.weight") { "lm_head" } else { words };
        let scales = config.scale_decoder_outputs.unwrap_or(config.tie_word_embeddings);
        let decoder_layers = config.num_decoder_layers.unwrap_or(config.num_layers);
        Ok(Self {
            words: weights.embedding(words, count, size)?,
            encoder: Stack::load(&weights.sub("encoder"), config, config.num_layers, false)?,
            decoder: Stack::load(&weights.sub("decoder"), config, decoder_layers, true)?,
            head: weights.linear(head, size, count)?,
            scale: scales.then(|| 1.0 / (size as f64).sqrt()),
            begin: config.decoder_start_token_id,
            end: config.eos_token_id,
        })
    }

    /// The tokens of the answer to a picture's tokens [1, count, size] and a prompt's ids [1, length].
    pub(super) fn speak(&self, seen: &Tensor, ids: &Tensor, most: usize) -> Result<Vec<u32>> {
        let read = self.encoder.read(&Tensor::cat(&[seen, &self.words.of(ids)?], 1)?)?;
        let attended = self.decoder.attended(&read)?;
        let mut past = vec![Past::default(); self.decoder.blocks.len()];
        greedy(most, self.end, |token| {
            let token = self.words.of(&Tensor::new(&[[token.unwrap_or(self.begin)]], seen.device())?)?;
            let states = self.decoder.go_on(&token, &attended, &mut past)?;
            let states = self.scale.map_or(Ok(states.clone()), |scale| states * scale)?;
            self.head.of(&states)
        })
    }
}

impl Stack {
    fn load(
        weights: &Scope<'_>,
        config: &T5Config,
        layers: usize,
        is_decoder: bool,
    ) -> std::result::Result<Self, LocalError> {
        let blocks = weights.sub("block");
        let bias = blocks.sub("0.layer.0.SelfAttention");
        let buckets = config.relative_attention_num_buckets;
        Ok(Self {
            blocks: (0..layers)
                .map(|at| Block::load(&blocks.sub(at).sub("layer"), config, is_decoder))
                .collect::<std::result::Result<_, _>>()?,
            norm: weights.rms_norm("final_layer_norm", config.d_model, config.layer_norm_epsilon)?,
            distances: Distances {
                table: bias.embedding("relative_attention_bias", buckets, config.num_heads)?,
                buckets,
                farthest: config.relative_attention_max_distance,
                both_ways: !is_decoder,
            },
        })
    }

    /// The states of a whole text [1, length, size]. Each token sees all others.
    fn read(&self, x: &Tensor) -> Result<Tensor> {
        let bias = self.distances.bias(0, x.dim(1)?, x)?;
        let read = |x, block: &Block| block.of(&x, &bias, None, &mut Past::default());
        self.norm.of(&self.blocks.iter().try_fold(x.clone(), read)?)
    }

    fn attended(&self, read: &Tensor) -> Result<Attended> {
        let keys_values = |cross: &Cross| {
            let both = cross.keys_values.of(read)?;
            let width = both.dim(2)? / 2;
            Ok((both.narrow(2, 0, width)?, both.narrow(2, width, width)?))
        };
        self.blocks.iter().filter_map(|block| block.cross.as_ref()).map(keys_values).collect()
    }

    /// The states of the next tokens [1, length, size].
    fn go_on(&self, x: &Tensor, attended: &Attended, past: &mut [Past]) -> Result<Tensor> {
        let before = past.first().map_or(Ok(0), Past::len)?;
        let length = x.dim(1)?;
        let mut bias = self.distances.bias(before, length, x)?;
        if length > 1 {
            bias = bias.broadcast_add(&causal(length, before + length, x.device())?)?;
        }
        let mut x = x.clone();
        for ((block, attended), past) in self.blocks.iter().zip(attended).zip(past) {
            x = block.of(&x, &bias, Some(attended), past)?;
        }
        self.norm.of(&x)
    }
}

impl Distances {
    /// The numbers [1, heads, length, before + length] that are added to the scores of `length` queries after `before`
    /// tokens.
    fn bias(&self, before: usize, length: usize, like: &Tensor) -> Result<Tensor> {
        let keys = before + length;
        let buckets = (0..length * keys).map(|at| self.bucket((at % keys) as i64 - (before + at / keys) as i64));
        let buckets = Tensor::from_iter(buckets, like.device())?.reshape((length, keys))?;
        self.table.of(&buckets)?.permute((2, 0, 1))?.unsqueeze(0)?.contiguous()
    }

    /// The bucket of a distance from query to key (Mesh TensorFlow's `_relative_position_bucket`).
    fn bucket(&self, distance: i64) -> u32 {
        let (buckets, first) = match (self.both_ways, distance > 0) {
            (true, true) => (self.buckets / 2, self.buckets / 2),
            (true, false) => (self.buckets / 2, 0),
            (false, _) => (self.buckets, 0),
        };
        let far = if self.both_ways { distance.unsigned_abs() } else { (-distance).max(0).unsigned_abs() } as usize;
        // Half of the buckets are for one distance each. The others are for ranges that become wider with the distance.
        let exact = buckets / 2;
        if far < exact {
            return (first + far) as u32;
        }
        let ratio = (far as f32 / exact as f32).ln() / (self.farthest as f32 / exact as f32).ln();
        let wide = exact + (ratio * (buckets - exact) as f32) as usize;
        (first + wide.min(buckets - 1)) as u32
    }
}

impl Block {
    fn load(weights: &Scope<'_>, config: &T5Config, is_decoder: bool) -> std::result::Result<Self, LocalError> {
        let (size, width, inner) = (config.d_model, config.num_heads * config.d_kv, config.d_ff);
        let norm = |name: &str| weights.rms_norm(name, size, config.layer_norm_epsilon);
        let cross = || -> std::result::Result<Cross, LocalError> {
            let attention = weights.sub("1.EncDecAttention");
            Ok(Cross {
                norm: norm("1.layer_norm")?,
                query: attention.linear("q", size, width)?,
                keys_values: attention.linears(&["k", "v"], size, width)?,
                mixed: attention.linear("o", width, size)?,
            })
        };
        let feed = if is_decoder { "2" } else { "1" };
        let dense = weights.sub(feed).sub("DenseReluDense");
        Ok(Self {
            norm: norm("0.layer_norm")?,
            qkv: weights.sub("0.SelfAttention").linears(&["q", "k", "v"], size, width)?,
            mixed: weights.linear("0.SelfAttention.o", width, size)?,
            cross: if is_decoder { Some(cross()?) } else { None },
            wide_norm: norm(&format!("{feed}.layer_norm"))?,
            gate: dense.linear("wi_0", size, inner)?,
            wide: dense.linear("wi_1", size, inner)?,
            narrow: dense.linear("wo", inner, size)?,
            heads: config.num_heads,
            activation: config.dense_act_fn.unwrap_or(Activation::GeluTanh),
        })
    }

    /// Self-attention, attention to the encoder's states in a decoder, and the gated layers, each with a residual. T5
    /// does not scale its attention scores.
    fn of(&self, x: &Tensor, bias: &Tensor, attended: Option<&(Tensor, Tensor)>, past: &mut Past) -> Result<Tensor> {
        let qkv = self.qkv.of(&self.norm.of(x)?)?;
        let width = qkv.dim(2)? / 3;
        let part = |at: usize| qkv.narrow(2, at * width, width);
        let (keys, values) = past.grow(part(1)?, part(2)?)?;
        let mixed = Attention { heads: self.heads, scale: 1.0, bias: Some(bias) }.of(&part(0)?, &keys, &values)?;
        let mut x = (self.mixed.of(&mixed)? + x)?;
        if let (Some(cross), Some((keys, values))) = (&self.cross, attended) {
            let query = cross.query.of(&cross.norm.of(&x)?)?;
            let mixed = Attention { heads: self.heads, scale: 1.0, bias: None }.of(&query, keys, values)?;
            x = (cross.mixed.of(&mixed)? + x)?;
        }
        let normed = self.wide_norm.of(&x)?;
        let gated = (self.gate.of_then(&normed, self.activation)? * self.wide.of(&normed)?)?;
        self.narrow.of(&gated)? + x
    }
}

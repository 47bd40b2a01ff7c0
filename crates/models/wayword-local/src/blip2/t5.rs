//! The language model FlanT5 (arXiv 1910.10683, 2210.11416): an encoder reads picture and prompt, and a decoder writes
//! the answer.
//!
//! T5 has no position embeddings. Instead the distance between two tokens adds a learned number to their attention
//! score. Far distances share such numbers in buckets: 5 has its own, while 90 and 100 may have the same.

use super::config::T5Config;
use crate::{
    LocalError,
    greedy::decode_greedily,
    ops::{Activation, EmbeddingTable, KeyValueCache, LinearLayer, MultiHeadAttention, RmsNorm, causal_mask},
    weights::WeightScope,
};
use candle_core::{Result, Tensor};

/// A T5 with gated layers: the product of two linear layers goes through a third one.
pub(super) struct T5Model {
    words: EmbeddingTable,
    encoder: T5Stack,
    decoder: T5Stack,
    head: LinearLayer,
    /// The factor for the decoder's states.
    scale: Option<f64>,
    /// The ids of the tokens that begin and end an answer.
    begin: u32,
    end: u32,
}

/// The encoder or the decoder: blocks, one behind the other.
struct T5Stack {
    blocks: Vec<T5Block>,
    norm: RmsNorm,
    distances: T5DistanceBias,
}

/// The numbers [buckets, heads] that the distance between two tokens adds to their score, by bucket and head.
struct T5DistanceBias {
    table: EmbeddingTable,
    buckets: usize,
    /// The distance from which on all distances share the last bucket, tokens.
    farthest: usize,
    /// Whether later tokens have buckets of their own. They have in the encoder; the decoder does not see later tokens.
    both_ways: bool,
}

/// One block: attention among the tokens, in the decoder attention to the encoder's states, then the gated layers.
struct T5Block {
    norm: RmsNorm,
    /// The layer for queries, keys and values, side by side.
    qkv: LinearLayer,
    /// The layer behind the attention.
    mixed: LinearLayer,
    cross: Option<T5CrossAttention>,
    wide_norm: RmsNorm,
    /// The gated layers: `narrow(activation(gate(x)) * wide(x))`.
    gate: LinearLayer,
    wide: LinearLayer,
    narrow: LinearLayer,
    heads: usize,
    activation: Activation,
}

/// Attention to the encoder's states.
struct T5CrossAttention {
    norm: RmsNorm,
    query: LinearLayer,
    keys_values: LinearLayer,
    mixed: LinearLayer,
}

/// The keys and values of the encoder's states, block by block.
type T5KeysValues = Vec<(Tensor, Tensor)>;

impl T5Model {
    pub(super) fn from_weights(weights: &WeightScope<'_>, config: &T5Config) -> std::result::Result<Self, LocalError> {
        let (size, count) = (config.d_model, config.vocab_size);
        // Checkpoints leave out tensors that are tied to another one.
        let words = if weights.has_tensor("shared.weight") { "shared" } else { "encoder.embed_tokens" };
        let head = if weights.has_tensor("lm_head.weight") { "lm_head" } else { words };
        let scales = config.scale_decoder_outputs.unwrap_or(config.tie_word_embeddings);
        let decoder_layers = config.num_decoder_layers.unwrap_or(config.num_layers);
        Ok(Self {
            words: weights.read_embedding(words, count, size)?,
            encoder: T5Stack::from_weights(&weights.sub_scope("encoder"), config, config.num_layers, false)?,
            decoder: T5Stack::from_weights(&weights.sub_scope("decoder"), config, decoder_layers, true)?,
            head: weights.read_linear(head, size, count)?,
            scale: scales.then(|| 1.0 / (size as f64).sqrt()),
            begin: config.decoder_start_token_id,
            end: config.eos_token_id,
        })
    }

    /// The tokens of the answer to a picture's tokens [1, count, size] and a prompt's ids [1, length]: at
    /// most `max_tokens`.
    pub(super) fn generate_tokens(&self, picture: &Tensor, ids: &Tensor, max_tokens: usize) -> Result<Vec<u32>> {
        let encoded = self.encoder.encode_text(&Tensor::cat(&[picture, &self.words.look_up(ids)?], 1)?)?;
        let attended = self.decoder.cross_keys_values(&encoded)?;
        let mut past = vec![KeyValueCache::default(); self.decoder.blocks.len()];
        decode_greedily(max_tokens, self.end, |token| {
            let token = self.words.look_up(&Tensor::new(&[[token.unwrap_or(self.begin)]], picture.device())?)?;
            let states = self.decoder.continue_text(&token, &attended, &mut past)?;
            let states = self.scale.map_or(Ok(states.clone()), |scale| states * scale)?;
            self.head.apply_to(&states)
        })
    }
}

impl T5Stack {
    fn from_weights(
        weights: &WeightScope<'_>,
        config: &T5Config,
        layers: usize,
        is_decoder: bool,
    ) -> std::result::Result<Self, LocalError> {
        let blocks = weights.sub_scope("block");
        let bias = blocks.sub_scope("0.layer.0.SelfAttention");
        let buckets = config.relative_attention_num_buckets;
        Ok(Self {
            blocks: (0..layers)
                .map(|at| T5Block::from_weights(&blocks.sub_scope(at).sub_scope("layer"), config, is_decoder))
                .collect::<std::result::Result<_, _>>()?,
            norm: weights.read_rms_norm("final_layer_norm", config.d_model, config.layer_norm_epsilon)?,
            distances: T5DistanceBias {
                table: bias.read_embedding("relative_attention_bias", buckets, config.num_heads)?,
                buckets,
                farthest: config.relative_attention_max_distance,
                both_ways: !is_decoder,
            },
        })
    }

    /// The states of a whole text [1, length, size]. Each token sees all others.
    fn encode_text(&self, x: &Tensor) -> Result<Tensor> {
        let bias = self.distances.score_bias(0, x.dim(1)?, x)?;
        let apply_block = |x, block: &T5Block| block.apply_to(&x, &bias, None, &mut KeyValueCache::default());
        self.norm.apply_to(&self.blocks.iter().try_fold(x.clone(), apply_block)?)
    }

    /// The keys and values of the encoder's states, block by block.
    fn cross_keys_values(&self, encoded: &Tensor) -> Result<T5KeysValues> {
        let keys_values = |cross: &T5CrossAttention| {
            let both = cross.keys_values.apply_to(encoded)?;
            let width = both.dim(2)? / 2;
            Ok((both.narrow(2, 0, width)?, both.narrow(2, width, width)?))
        };
        self.blocks.iter().filter_map(|block| block.cross.as_ref()).map(keys_values).collect()
    }

    /// The states of the next tokens [1, length, size], after those of `past`.
    fn continue_text(&self, x: &Tensor, attended: &T5KeysValues, past: &mut [KeyValueCache]) -> Result<Tensor> {
        let past_length = past.first().map_or(Ok(0), KeyValueCache::len)?;
        let length = x.dim(1)?;
        let mut bias = self.distances.score_bias(past_length, length, x)?;
        if length > 1 {
            bias = bias.broadcast_add(&causal_mask(length, past_length + length, x.device())?)?;
        }
        let mut x = x.clone();
        for ((block, attended), past) in self.blocks.iter().zip(attended).zip(past) {
            x = block.apply_to(&x, &bias, Some(attended), past)?;
        }
        self.norm.apply_to(&x)
    }
}

impl T5DistanceBias {
    /// The numbers [1, heads, length, before + length] that are added to the scores of `length` queries after `before`
    /// tokens.
    fn score_bias(&self, before: usize, length: usize, like: &Tensor) -> Result<Tensor> {
        let keys = before + length;
        let buckets =
            (0..length * keys).map(|at| self.distance_bucket((at % keys) as i64 - (before + at / keys) as i64));
        let buckets = Tensor::from_iter(buckets, like.device())?.reshape((length, keys))?;
        self.table.look_up(&buckets)?.permute((2, 0, 1))?.unsqueeze(0)?.contiguous()
    }

    /// The bucket of a distance from query to key (Mesh TensorFlow's `_relative_position_bucket`).
    fn distance_bucket(&self, distance: i64) -> u32 {
        let (buckets, first) = match (self.both_ways, distance > 0) {
            (true, true) => (self.buckets / 2, self.buckets / 2),
            (true, false) => (self.buckets / 2, 0),
            (false, _) => (self.buckets, 0),
        };
        let tokens = if self.both_ways { distance.unsigned_abs() } else { (-distance).max(0).unsigned_abs() } as usize;
        // Half of the buckets are for one distance each. The others are for ranges that become wider with the distance.
        let exact = buckets / 2;
        if tokens < exact {
            return (first + tokens) as u32;
        }
        let ratio = (tokens as f32 / exact as f32).ln() / (self.farthest as f32 / exact as f32).ln();
        let bucket = exact + (ratio * (buckets - exact) as f32) as usize;
        (first + bucket.min(buckets - 1)) as u32
    }
}

impl T5Block {
    fn from_weights(
        weights: &WeightScope<'_>,
        config: &T5Config,
        is_decoder: bool,
    ) -> std::result::Result<Self, LocalError> {
        let (size, width, inner) = (config.d_model, config.num_heads * config.d_kv, config.d_ff);
        let norm = |name: &str| weights.read_rms_norm(name, size, config.layer_norm_epsilon);
        let cross = || -> std::result::Result<T5CrossAttention, LocalError> {
            let attention = weights.sub_scope("1.EncDecAttention");
            Ok(T5CrossAttention {
                norm: norm("1.layer_norm")?,
                query: attention.read_linear("q", size, width)?,
                keys_values: attention.read_joined_linears(&["k", "v"], size, width)?,
                mixed: attention.read_linear("o", width, size)?,
            })
        };
        let feed = if is_decoder { "2" } else { "1" };
        let dense = weights.sub_scope(feed).sub_scope("DenseReluDense");
        Ok(Self {
            norm: norm("0.layer_norm")?,
            qkv: weights.sub_scope("0.SelfAttention").read_joined_linears(&["q", "k", "v"], size, width)?,
            mixed: weights.read_linear("0.SelfAttention.o", width, size)?,
            cross: if is_decoder { Some(cross()?) } else { None },
            wide_norm: norm(&format!("{feed}.layer_norm"))?,
            gate: dense.read_linear("wi_0", size, inner)?,
            wide: dense.read_linear("wi_1", size, inner)?,
            narrow: dense.read_linear("wo", inner, size)?,
            heads: config.num_heads,
            activation: config.dense_act_fn.unwrap_or(Activation::GeluTanh),
        })
    }

    /// Self-attention, attention to the encoder's states in a decoder, and the gated layers, each with a residual. T5
    /// does not scale its attention scores.
    fn apply_to(
        &self,
        x: &Tensor,
        bias: &Tensor,
        attended: Option<&(Tensor, Tensor)>,
        past: &mut KeyValueCache,
    ) -> Result<Tensor> {
        let qkv = self.qkv.apply_to(&self.norm.apply_to(x)?)?;
        let width = qkv.dim(2)? / 3;
        let part = |at: usize| qkv.narrow(2, at * width, width);
        let (keys, values) = past.append_tokens(part(1)?, part(2)?)?;
        let mixed = MultiHeadAttention { heads: self.heads, scale: 1.0, bias: Some(bias) }.attend_to(
            &part(0)?,
            &keys,
            &values,
        )?;
        let mut x = (self.mixed.apply_to(&mixed)? + x)?;
        if let (Some(cross), Some((keys, values))) = (&self.cross, attended) {
            let query = cross.query.apply_to(&cross.norm.apply_to(&x)?)?;
            let mixed =
                MultiHeadAttention { heads: self.heads, scale: 1.0, bias: None }.attend_to(&query, keys, values)?;
            x = (cross.mixed.apply_to(&mixed)? + x)?;
        }
        let normed = self.wide_norm.apply_to(&x)?;
        let gated = (self.gate.apply_and_activate(&normed, self.activation)? * self.wide.apply_to(&normed)?)?;
        self.narrow.apply_to(&gated)? + x
    }
}

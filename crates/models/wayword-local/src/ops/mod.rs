//! The operators of this crate's models: linear layers, attention, norms, activations, convolutions.
//!
//! On the CPU each operator makes one pass over candle's tensors, with the kernels of `rten-gemm` and `rten-vecmath`.
//! candle's own operators are 1.5 to 4 times slower there, because they pack weights again for each product and run
//! GELU, bias and softmax on one thread. On any other device candle's own operators are used.

mod activation;
mod attention;
pub(crate) mod conv3;
mod embedding;
mod feed_forward;
mod half;
pub(crate) mod kernels;
mod linear;
pub(crate) mod matrix;
mod norm;
mod packed;
mod rows;
mod softmax;
pub(crate) mod tiles;

pub(crate) use activation::Activation;
pub(crate) use attention::{KeyValueCache, MultiHeadAttention, causal_mask};
pub(crate) use embedding::{EmbeddingTable, cut_patches};
pub(crate) use feed_forward::FeedForward;
pub(crate) use linear::LinearLayer;
pub(crate) use norm::{LayerNorm, RmsNorm};

#[cfg(test)]
mod tests;

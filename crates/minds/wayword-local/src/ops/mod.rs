//! The operators that our models are made of.
//!
//! On the processor each is one pass of our own over candle's tensors, on the kernels of `rten-gemm` and `rten-vecmath`: candle's
//! own are 1.5 to 4 times slower there, because they pack weights anew for each product and run GELU, bias and softmax on one
//! thread. On any other device they are candle's own.

mod activation;
mod attention;
mod embedding;
mod half;
mod kernels;
mod linear;
mod norm;

pub(crate) use activation::Activation;
pub(crate) use attention::{Attention, Past, causal};
pub(crate) use embedding::{Embedding, patches};
pub(crate) use linear::Linear;
pub(crate) use norm::{LayerNorm, RmsNorm};

#[cfg(test)]
mod tests;

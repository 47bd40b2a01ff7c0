//! GLIP: finds things in pictures by phrases, with text and picture joined at every layer of its head (GLIP-T and its
//! variants A, B and C, from the original checkpoints).

mod boxes;
mod channel_means;
mod config;
mod detector;
mod enlargement;
mod files;
mod fusion;
mod head;
mod model;
mod prompt;
mod pyramid;
mod tower;

pub(crate) use detector::FEATURE_CACHE_BYTES;
pub use detector::GlipDetector;
pub use files::GlipFiles;

/// The repository with the `tokenizer.json` for GLIP's texts. GLIP's checkpoints come without a tokenizer.
pub const GLIP_TOKENIZER: &str = "hf/google-bert/bert-base-uncased";

/// A note on the licence, which a user of the weights gets once.
pub const GLIP_LICENCE: &str = "GLIP's code has the MIT licence, but its makers state no licence for the weights: find out whether you may use them for your purpose, and do not pass them on";

use crate::{LocalError, weights::WeightScope};

/// A small tensor as numbers on the CPU.
fn read_numbers(weights: &WeightScope<'_>, name: &str, shape: &[usize]) -> Result<Vec<f32>, LocalError> {
    let read = |tensor: candle_core::Tensor| tensor.to_dtype(candle_core::DType::F32)?.flatten_all()?.to_vec1();
    read(weights.read_tensor(name, shape)?).map_err(|error| weights.tensor_error(name, &error))
}

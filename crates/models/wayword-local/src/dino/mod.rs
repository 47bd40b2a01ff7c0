//! The Grounding DINO family: finds things in pictures by phrases. MM Grounding DINO, LLMDet and Grounding DINO have
//! one architecture with a few switches, which are in the configuration.
//!
//! The order of the computation: `features` cuts a picture into cells, `text` reads the phrases, `encoder` lets both
//! look at each other, `queries` picks the cells that fit the phrases best, and `decoder` refines a box for each of
//! them.

mod backbone;
mod config;
mod decoder;
mod deformable;
mod detect;
mod encoder;
mod features;
mod fusion;
mod heads;
mod layers;
mod model;
mod picture;
mod position;
mod prompt;
mod queries;
mod text;

pub(crate) use model::FEATURE_CACHE_BYTES;
pub use model::{DinoOutputs, GroundingDino};

/// A result of reading weights; `Result` alone is that of a computation.
type LoadResult<T> = std::result::Result<T, crate::LocalError>;

#[cfg(test)]
mod tests;

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

pub(crate) use model::KEPT_BYTES;
pub use model::{DinoOutputs, GroundingDino};

#[cfg(test)]
mod tests;

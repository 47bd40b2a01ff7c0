//! The Grounding DINO family: finds things in pictures by phrases. MM Grounding DINO, LLMDet and Grounding DINO have one
//! architecture with a few switches, which the configuration states.

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
pub use model::{Dino, DinoOutputs};

#[cfg(test)]
mod tests;

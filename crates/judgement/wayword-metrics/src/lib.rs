//! Figures about instructions, each with its interval and with what it has to be read beside.
//!
//! Architecture invariant: pure functions. Nothing here reads a file, knows a platform or runs a model; vectors come from the
//! caller.

mod bootstrap;
mod similarity;
mod words;

pub use bootstrap::{Estimate, clustered_interval};
pub use similarity::{Drawing, Said, Similarity, similarity};
pub use words::Words;

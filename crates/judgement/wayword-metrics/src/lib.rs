//! Figures about instructions and trajectories, each with its interval and with what it has to be read beside.
//!
//! Architecture invariant: pure functions. Nothing here reads a file, knows a platform or runs a model; vectors come from the
//! caller.

mod bootstrap;
mod mcnemar;
mod similarity;
mod trajectory;
mod words;

pub use bootstrap::{Estimate, clustered_interval};
pub use mcnemar::McNemar;
pub use similarity::{Drawing, Said, Similarity, similarity};
pub use trajectory::{
    Atlas, Demand, Distances, Grounding, Invalid, Metric, Outcome, Rule, Score, Trajectory, problems, score,
};
pub use words::Words;

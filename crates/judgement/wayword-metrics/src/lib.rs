//! Figures about instructions and trajectories, each with its interval and with what it has to be read beside.
//!
//! Architecture invariant: nothing here reads a file, runs a model or knows a platform beyond the graph that it hands out; vectors
//! come from the caller. What is computed is kept ([`Atlas`]), and the same input gives the same figures.

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

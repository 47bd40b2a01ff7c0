//! Follows an instruction over a viewpoint graph: which walks it fits, and how well.
//!
//! [`Guide`] is an instruction, step by step. [`Building`] is what is known of the place, and [`Tree`] the walks that are
//! thought of. [`Fit`] says how well the text fits each of them: a walk is cut into stretches, one for each step, in all
//! ways. [`learn`] fits the weights.
//!
//! Architecture invariant: nothing here knows an agent, a writer or a file.

mod building;
pub mod change;
pub mod doubt;
mod features;
mod fit;
mod guide;
pub mod learn;
mod near;
mod one_walk;
pub mod online;
mod posterior;
pub mod route;
pub mod swap;
#[cfg(test)]
mod tests;
mod tree;
mod weights;

pub use building::{Building, Place};
pub use fit::{Fit, MOST_WORK};
pub use guide::{Guide, Trial};
pub use posterior::{best, shares};
pub use tree::{Prior, Tree};
pub use weights::{Weights, WeightsError};

//! Follows an instruction over a viewpoint graph: finds out which walks the text fits, and how well.
//!
//! [`Guide`] is an instruction, step by step, [`Building`] the known part of the place, and [`Tree`] the set of
//! possible walks. [`Fit`] scores each walk: it cuts the walk into stretches, one for each step of the text, in all
//! possible ways, and adds up weights of features such as "a left turn is described and the stretch bends left".
//! [`learn`] fits these weights to texts of known walks.
//!
//! Architecture invariant: no module here knows an agent, a writer or a file.

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

//! Follows an instruction over a viewpoint graph: finds out which walks the text fits, and how well.
//!
//! [`Guide`] is an instruction, step by step, [`KnownBuilding`] the known part of the place, and [`WalkTree`] the set of
//! possible walks. [`WalkFit`] scores each walk: it cuts the walk into stretches, one for each step of the text, in all
//! possible ways, and adds up weights of features such as "a left turn is described and the stretch bends left".
//! [`learn_decision`] fits these weights to texts of known walks.
//!
//! Architecture invariant: no module here knows an agent, a writer or a file.

mod building;
pub mod change;
pub mod doubt;
mod features;
mod fit;
mod guide;
pub mod learn;
mod nearness;
mod one_walk;
pub mod online;
mod posterior;
pub mod route;
pub mod swap;
#[cfg(test)]
mod tests;
mod tree;
mod weights;

pub use building::{KnownBuilding, PathPlace};
pub use fit::{MOST_WORK, WalkFit};
pub use guide::{Guide, GuideTrial};
pub use posterior::{best_walk, walk_shares};
pub use tree::{WalkPrior, WalkTree};
pub use weights::{FeatureWeights, WeightsError};

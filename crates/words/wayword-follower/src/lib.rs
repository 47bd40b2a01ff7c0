//! Follows an instruction over a viewpoint graph: finds out which walks the text fits, and how well.
//!
//! [`Guide`] is an instruction, step by step, [`KnownBuilding`] the known part of the place, and [`WalkTree`] the set of
//! possible walks. [`WalkFit`] scores each walk: it cuts the walk into stretches, one for each step of the text, in all
//! possible ways, and adds up weights of features such as "a left turn is described and the stretch bends left".
//! [`learn`] fits these weights to texts of known walks.
//!
//! Architecture invariant: no module here knows an agent, a writer or a file.
//!
//! # Where things are
//! - [`alignment`]: the parts of a text, each with its stretch of a known walk.
//! - [`change`], [`swap`]: wrong turns and swapped places. [`route`] has the gains from which they count, and texts that lead elsewhere.
//! - [`doubt`]: `mod.rs`, `ways.rs` and `other_places.rs` find words to doubt and others for them; `bounds.rs` has the gains, `from_checks.rs` the
//!   doubts that come from checks and ambiguity.
//! - `guide`: the steps of a text. `features/`: the features of a step on a walk. `tree`: the walks that a text may mean.
//! - `walk_on_graph`: a walk between the viewpoints of a graph, put onto it.
//! - [`online`]: the same without a map, and going on to the unknown.
//! - `weights/fitted.json`, `online/fitted.json`: the weights, fitted by [`learn`] and `wayword-measure fit-follower`.

pub mod alignment;
mod building;
mod building_parts;
pub mod change;
pub mod doubt;
mod features;
mod fit;
mod guide;
pub mod learn;
#[cfg(test)]
mod made_buildings;
mod nearness;
mod one_walk;
pub mod online;
pub mod pair;
mod posterior;
pub mod route;
pub mod swap;
#[cfg(test)]
mod tests;
mod tree;
mod walk_on_graph;
mod weights;

pub use building::{KnownBuilding, PathPlace, PathThing, counts_as_seen};
pub use fit::{MAX_FOLLOW_WORK, WalkFit};
pub use guide::{Guide, GuideTrial};
pub use posterior::{best_walk, walk_shares};
pub use tree::{WalkPrior, WalkTree};
pub use walk_on_graph::WalkOnGraph;
pub use weights::{FeatureWeights, WeightsError};

//! A follower that walks without a map: it knows only the viewpoints where it was and their neighbours, and decides at
//! each where to go.

mod map;
mod onward;
mod reader;

pub use map::{ThingDirection, WalkerHop, WalkerSighting, WalkerThing};
pub(crate) use onward::{HOPS_AWAY_CLASSES, STEPS_LEFT_CLASSES};
pub use onward::{OnwardFit, OnwardLearner, OnwardSlope, OnwardWeights};
pub use reader::{WalkerDecision, WalkingFollower};

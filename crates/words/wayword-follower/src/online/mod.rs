//! A follower that walks without a map: it knows only the viewpoints where it was and their neighbours, and decides at
//! each where to go.

mod map;
mod onward;
mod reader;

pub use map::{Hop, Sighting};
pub(crate) use onward::{AWAY, LEFT};
pub use onward::{Onward, OnwardLearner, OnwardSlope, OnwardWeights};
pub use reader::{Decision, Reader};

//! The parts that need no model: answers from ground-truth labels, and rules that find how a target differs from
//! similar objects.

mod describe;
mod distinguish;
mod labels;
mod listed;

pub use describe::{BuildingListing, describe_target};
pub use distinguish::list_around_frame;
pub use labels::LabelAnswerer;

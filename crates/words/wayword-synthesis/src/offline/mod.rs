//! The parts that need no model: answers from ground-truth labels, and rules that find how a target differs from
//! similar objects.

mod around_frame;
mod describe;
mod labels;
mod structured_answer;

pub use around_frame::list_around_frame;
pub use describe::{BuildingListing, approach_frames, describe_target};
pub use labels::LabelAnswerer;

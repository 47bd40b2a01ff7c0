//! What needs no model: answers from ground-truth labels, and rules for how a target differs from others of its name.

mod distinguish;
mod labels;
mod listed;

pub use distinguish::distinguish;
pub use labels::Labels;

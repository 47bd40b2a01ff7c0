//! What needs no model: answers from ground-truth labels, and rules for how a target differs from everything else.

mod describe;
mod distinguish;
mod labels;
mod listed;

pub use describe::{Listing, describe};
pub use distinguish::around;
pub use labels::Labels;

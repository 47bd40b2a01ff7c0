//! Can an agent find the way by it? Zero-shot agents walk the viewpoint graph by instructions, and sets of instructions are
//! held against each other by how well they walk.
//!
//! Architecture invariant: an agent is told an instruction and, at each node, how well its phrases fit four views: no pose, no
//! goal, no map. What is told more says so in its name (`agents::floors`). Nothing here opens a file, and nothing knows a
//! platform beyond the trait.

pub mod agents;
pub mod comparison;
pub mod directions;
mod error;
mod eyes;
pub mod grounders;
pub mod swap;
#[cfg(test)]
mod testing;
pub mod walk;

pub use error::WalkError;
pub use eyes::{Eyes, Seen, Sight};

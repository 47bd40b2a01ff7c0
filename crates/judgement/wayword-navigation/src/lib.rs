//! Can an agent find the way by it? Zero-shot agents walk the viewpoint graph by instructions, and sets of instructions are
//! held against each other by how well they walk.
//!
//! Architecture invariant: an agent is told an instruction and, at each node, how well its phrases fit four views: no pose, no
//! goal, no map. What is told more says so in its name (`floors`). Nothing here opens a file, and nothing knows a platform beyond
//! the trait.

pub mod comparison;
pub mod directions;
pub mod swap;
pub mod walk;

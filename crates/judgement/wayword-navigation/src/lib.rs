//! Can an agent find the way by an instruction? Zero-shot agents walk the viewpoint graph by instructions, and sets of
//! instructions are compared by how well the agents do.
//!
//! Architecture invariant: an agent gets an instruction and, at each node, how well its phrases fit four views. It gets
//! no pose, no goal and no map. Agents that know more are in `agents::baselines`. Nothing here opens a file, and
//! nothing knows a platform beyond the trait.

pub mod agents;
pub mod comparison;
pub mod directions;
mod error;
pub mod grounders;
mod sight;
pub mod swap;
#[cfg(test)]
mod testing;
pub mod walk;

pub use error::WalkError;
pub use sight::{AgentView, Seen, Sight};

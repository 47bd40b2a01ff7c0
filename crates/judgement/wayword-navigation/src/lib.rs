//! Can an agent find the way by an instruction? Zero-shot agents walk the viewpoint graph by instructions, and sets of
//! instructions are compared by how well the agents do.
//!
//! Architecture invariant: an agent gets an instruction and, at each node, only the input that `sight` makes for it. An agent
//! that walks by phrases gets how well they fit four views ([`NodeSight`]). An agent that reads gets the ways out of the node, its
//! room, and through which way each thing lies (`Sighting`). The agent with a language model gets the same in words, or pictures.
//! None of them gets a pose, a goal or a map of the scene. Agents that know more are in `agents::baselines` and
//! `agents::map_reader`. This crate opens no files, and uses platforms only through the trait.
//!
//! # Where things are
//! - `sight`, `sight/sighting.rs`: all that agents learn of a node.
//! - `agents/policy.rs`, `parameters.rs`: how agents that walk by phrases decide, and their thresholds.
//! - `agents/reader.rs`, `map_reader.rs`: agents that read. How they decide is in `wayword-follower`.
//! - `agents/tools/`: the agent with a language model: its loop `walker.rs`, bounds `limits.rs`, prompts `system.j2` and `state.j2`, its eyes
//!   `observed_scene.rs`, its map `memory.rs`, the replies `tool_calls.rs`.
//! - `agents/baselines.rs`: lower and upper bounds.
//! - [`grounders`]: how phrases are scored by labels.
//! - [`directions`], [`swap`]: how instructions are taken apart and swapped.
//! - [`comparison`]: the table of a comparison and its figures; `effort_summary.rs`: what walks by a language model took.

pub mod agents;
pub mod comparison;
pub mod directions;
mod error;
pub mod grounders;
mod one_line;
mod sight;
pub mod swap;
#[cfg(test)]
mod testing;
pub mod walk;

pub use error::WalkError;
pub use sight::{AgentView, NodeSight, SightView, ThingSource};

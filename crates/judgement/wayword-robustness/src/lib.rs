//! Robustness: how much of the instructions changes when the world, its pictures or the paths change.
//!
//! A [`Change`] says what is changed and by how much. A change of a world is a wrapper over its
//! [`Platform`](wayword_core::Platform) ([`worlds`]), one of a path a function ([`paths`]). This crate writes no text:
//! its caller generates them in the changed world and gives them to the figures.
//!
//! Architecture invariant: nothing here reads a file, runs a model or knows a platform beyond the trait.

mod change;
mod draws;
pub mod paths;
pub mod worlds;

pub use change::{Change, ChangeError, Dose, Sees, Setting, Whole};
pub use paths::ChangedPath;

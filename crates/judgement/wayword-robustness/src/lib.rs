//! Robustness: how much of the instructions changes when the world, its pictures or the paths change.
//!
//! A [`Change`] says what is changed. A change of a world is a wrapper over its [`Platform`](wayword_core::Platform)
//! ([`worlds`]). This crate writes no text: its caller generates them in the changed world and gives them to the figures.
//!
//! Architecture invariant: nothing here reads a file, runs a model or knows a platform beyond the trait.

mod change;
pub mod metamorphic;
pub mod worlds;

pub use change::{Change, ChangeError, Dose, Sees, Setting, Whole};

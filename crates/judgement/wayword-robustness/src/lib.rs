//! Robustness: how much of the instructions changes when the world, its pictures or the paths change.
//!
//! A [`Change`] says what is changed and by how much. A change of a world is a wrapper over its
//! [`Platform`](wayword_core::Platform) ([`worlds`]), one of a path a function ([`paths`]). What a text has to be after a
//! change is in [`metamorphic`]. This crate writes no text: its caller generates them and gives them to the figures.
//!
//! Architecture invariant: nothing here reads a file, runs a model or knows a platform beyond the trait.

mod agreement;
mod change;
mod draws;
mod facts;
pub mod metamorphic;
pub mod paths;
pub mod ratio;
pub mod sets;
pub mod worlds;

pub use agreement::Agreement;
pub use change::{Change, ChangeError, Dose, Elsewhere, Sees, Setting, Whole};
pub use facts::{Facts, Floor};
pub use paths::ChangedPath;

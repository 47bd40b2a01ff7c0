//! Robustness: how much of the instructions changes when the world, its pictures or the paths change.
//!
//! A [`Change`] names one change and its dose. A change of a world is a wrapper over its [`Platform`](wayword_core::Platform)
//! ([`worlds`]); a change of a path is a function ([`paths`]). [`metamorphic`] checks whether a text after a change is what the change
//! should have made of the text before it. [`ratio`] and [`sets`] compute figures from many texts. This crate writes no texts itself:
//! its caller generates them and passes them in.
//!
//! Architecture invariant: this crate reads no files, runs no models, and knows platforms only by the trait.

mod agreement;
mod change;
mod draws;
mod facts;
pub mod metamorphic;
pub mod paths;
pub mod ratio;
pub mod sets;
pub mod worlds;

pub use agreement::TextAgreement;
pub use change::{Change, ChangeError, ChangeSetting, DoseKind, OtherPlatform, SightSource, WholeChange};
pub use facts::{FloorFact, TextFacts};
pub use paths::ChangedPath;

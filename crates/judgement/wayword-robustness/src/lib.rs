//! Robustness: how much of the instructions changes when the world, its pictures or the paths change.
//!
//! A [`Change`] names one change and its dose. A change of a world is a wrapper over its [`Platform`](wayword_core::Platform)
//! ([`worlds`]); a change of a path is a function ([`paths`]). [`metamorphic`] checks whether the text changes as it should:
//! in a mirrored world, for example, left becomes right. [`ratio`] and [`sets`] compute figures from many texts. This crate writes no
//! texts itself: its caller generates them and passes them in.
//!
//! Architecture invariant: this crate reads no files, runs no models, and knows platforms only by the trait.
//!
//! # Where things are
//! - `change/`: which changes there are, with names, units and doses; `refusal.rs`: on which platforms a
//!   change makes no sense, and is refused.
//! - `worlds/`: one file for each kind of change, over `altered_platform.rs`; `edits.rs` chooses the thing that is removed, added or recoloured.
//! - `worlds/eye.rs`: the scripted eye.
//! - `facts.rs`, `agreement.rs`: what a text states, and how far two texts agree.
//! - `ratio.rs`: how much a change matters to many texts; `sets.rs`: how sets of texts differ.

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

//! Robustness: how much of the instructions changes when the world, its pictures or the paths change.
//!
//! A change of a world is a wrapper over its [`Platform`](wayword_core::Platform) ([`worlds`]). What a text of the changed world
//! has to be, given the text of the unchanged one, is in [`metamorphic`]. This crate writes no text: its caller generates them
//! in both worlds.
//!
//! Architecture invariant: nothing here reads a file, runs a model or knows a platform beyond the trait.

pub mod metamorphic;
pub mod worlds;

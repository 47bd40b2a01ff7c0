//! From views to words: the dialogue, prompts, styles, writing and repair, and the roles that need no model.
//!
//! Architecture invariant: no module here opens a file or a connection, and none knows more of a platform than the
//! trait [`wayword_core::Platform`].

pub mod detection;
pub mod dialogue;
pub mod models;
pub mod observe;
pub mod offline;
pub mod perception;
pub mod prompts;
pub mod repair;
pub mod seeing;
pub mod style;
pub mod walk;
mod weighted_draw;
pub mod writer;

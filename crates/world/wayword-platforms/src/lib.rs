//! Two platforms: Matterport3D, and any simulator as a child process.
//!
//! [`matterport`] reads Matterport3D's buildings from the files of the dataset, its simulator and REVERIE. [`process`]
//! gets paths and views from another program, over its standard input and output.
//!
//! # Where things are
//! - `matterport/`: one file for each file of the dataset, and `labels.rs`, which chooses between REVERIE's boxes and `.house` files.
//! - `process/protocol.rs`, `answer.rs`: the greeting of a child, and which lines it may answer with.
//! - `process/child_keeper.rs`: how often a child is started again.
//! - `process/group.rs`, `guard.rs`: how a child and all processes that it started are ended.
//! - `process/fault.rs`: everything that can go wrong with a child, and whether that is missing, broken or lost.
//!
//! A new platform is a module here or a crate beside this one, and a line in `platforms` of `wayword-run`.

pub mod matterport;
pub mod process;

pub use matterport::MatterportPlatform;
pub use process::ProcessPlatform;

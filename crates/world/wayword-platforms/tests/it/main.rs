//! The integration tests of `wayword-platforms`, one program: a module for each topic.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod matterport;
mod matterport_mutations;
mod matterport_pictures;
mod matterport_real;
mod process;
mod process_python;

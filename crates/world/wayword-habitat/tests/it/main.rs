//! The integration tests of `wayword-habitat`, one program: a module for each topic.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod frames_real;
mod house_export;
mod navmesh_real;
mod oracles;
mod scenes_real;
mod walks_real;

//! The integration tests of `wayword-queue`, one program: a module for each topic.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod cloud;
mod cloud_killed;
mod cloud_lost;
mod launch;
mod model;
mod parity;

//! The integration tests of `wayword-follower`, one program: what stays the same when a building and its text are changed
//! together.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod alike_buildings;

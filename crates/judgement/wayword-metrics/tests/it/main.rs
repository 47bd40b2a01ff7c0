//! The integration tests of `wayword-metrics`, one program: a module for each topic.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod atlas;
mod captions;
mod common;
mod parity;
mod parity_real;
mod study;

//! The integration tests of `wayword-testkit`, one program: a module for each topic.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod provider_dialects;
mod provider_faults;
mod read_back;

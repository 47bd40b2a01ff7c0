//! The integration tests of `wayword-render`, one program: a module for each topic.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod cubemap;
mod drawing;
mod matterport_oracle;
mod same_everywhere;

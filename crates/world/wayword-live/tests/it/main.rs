//! The integration tests of `wayword-live`, one program: a module for each topic.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod controller;
mod genuine_tdw;
mod genuine_virtualhome;
mod tdw_platform;
mod virtualhome;

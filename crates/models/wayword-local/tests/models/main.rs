//! Models in process against the numbers of other implementations, which the scripts in `fixtures` made.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stderr,
    reason = "a test fails by panicking"
)]

mod bert;
mod blip;
mod blip2;
mod clip;
mod common;
mod detectors;
mod dino;
mod glip;
mod owl;

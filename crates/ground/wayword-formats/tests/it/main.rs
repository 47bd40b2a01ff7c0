//! The integration tests of `wayword-formats`, one program: a module for each topic.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;
mod exports;
mod found_files;
mod hear;
mod languages;
mod mutations;
mod real_files;
mod records;
mod refusals;
mod round_trip;
mod shared_paths;
mod submissions;
#[cfg(feature = "parquet")]
mod training_schemas;

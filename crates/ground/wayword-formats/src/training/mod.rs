//! Layouts that training code for navigation policies reads: what stands in their files, as each loader expects it. Pictures are the
//! caller's.
//!
//! docs/FORMATS.md says who reads which layout, and with which commits they were tried.

mod action_runs;
#[cfg(feature = "parquet")]
mod arrow_schema;
#[cfg(feature = "parquet")]
pub mod columns;
pub mod episode_lines;
#[cfg(feature = "parquet")]
pub mod internnav;
#[cfg(feature = "parquet")]
pub mod lerobot;
#[cfg(feature = "parquet")]
pub mod lerobot_language;
#[cfg(feature = "parquet")]
pub mod lerobot_texts;
pub mod motion_jpeg;
pub mod navid;
pub mod navila;
pub mod pretraining;
mod put_back;
pub mod streamvln;

pub use action_runs::{ActionRun, action_runs};
pub use put_back::{TextsOfWalk, TextsPutBack};

//! The command line of Wayword: configuration, wiring, progress, run folders and reports.
//!
//! This is a library beside the binary, so that `wayword-measure` runs exactly what users run.

mod at_once;
pub mod by_pictures;
mod calibration;
pub mod calls;
pub mod cli;
#[cfg(feature = "local")]
mod clip;
pub mod commands;
mod count;
pub mod demands;
pub mod doubts;
#[cfg(feature = "local")]
mod download_bar;
pub mod encoder;
pub mod episodes;
pub mod error;
pub mod follow;
mod in_order;
pub mod interrupt;
pub mod item;
pub mod looking_for;
mod losses;
pub mod output;
pub mod people;
pub mod pictures;
pub mod pipeline;
pub mod plan;
pub mod platforms;
pub mod report;
pub mod run;
pub mod settings;
mod similar;
pub mod styles;
pub mod team;
mod terms;
mod text_file;
mod texts;

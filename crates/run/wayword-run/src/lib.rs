//! A run: settings, models and their calls, platforms by name, the items and their pipeline, the plan, the run folder, and the
//! commands `generate`, `check` and `calibrate`.
//!
//! The command line, the reports, the experiments and the Python package are built on this crate.

pub mod calibrate;
pub mod calibration;
pub mod calls;
pub mod check;
#[cfg(feature = "local")]
pub mod clip;
pub mod count;
pub mod doubts;
#[cfg(feature = "local")]
pub mod download_bar;
pub mod error;
pub mod error_parts;
pub mod follow;
pub mod generate;
pub mod in_order;
pub mod interrupt;
pub mod item;
pub mod lookout;
pub mod losses;
pub mod output;
pub mod own_format;
pub mod parallel;
pub mod people;
pub mod pictures;
pub mod pipeline;
pub mod plan;
pub mod platforms;
pub mod run_folder;
pub mod scene_selection;
pub mod settings;
pub mod settings_file;
pub mod similar;
pub mod stores;
pub mod styles;
pub mod team;
pub mod terms;
pub mod text_file;
pub mod walk_ranking;
pub mod watch;

//! A run: settings, models and their calls, platforms by name, the items and their pipeline, the plan, the run folder, and the
//! commands `generate`, `check`, `align` and `calibrate`.
//!
//! The command line, the reports, the experiments and the Python package are built on this crate.
//!
//! # Where things are
//! - `settings/asked_settings.rs`, `roles.rs`, `service.rs`: a flag or a key of the settings file; `settings/mod.rs` if the run folder keeps it.
//!   `settings/sources.rs` is `--evidence`.
//! - [`plan`]: everything that is fixed before a run begins; `plan/estimate.rs`: calls, tokens and cost.
//! - [`team`]: what plays a role. [`lookout`]: the detector of a run. [`calls`]: models by name, the ledger, readiness.
//! - [`pipeline`]: how one item is made. [`in_order`], [`parallel`]: which work is done at the same time.
//! - [`run_folder`]: what a run keeps and how it continues; `run_folder/world_data.rs`: which files may not change; `folder_lock.rs`: one process at a time.
//! - `generate/keep.rs`, `progress.rs`: what becomes of failed items; `losses`: when a run ends because of them; `pace.rs`: the time left.
//! - `generate/workers/`: one worker of many. [`stores`]: addresses of object stores in place of folders.
//! - `annotate/`: language for datasets of LeRobot. [`pairs`]: how likely a text is wrong about its film.
//! - [`check`]: `check/worlds.rs` chooses the world of a text, `detecting.rs` is `--detector`, `run_texts.rs` for texts edited after an export,
//!   `again.rs` for those of a report.
//! - [`follow`], [`doubts`], [`walk_ranking`]: what the program does with the follower.
//! - [`episode_paths`]: an episode of a dataset as a path. [`platforms`]: platforms by name. [`scene_selection`]: which scenes a run leaves out. [`terms`]: what needs `--i-have-the-right`.
//! - [`error`]: errors and exit codes. [`interrupt`]: Ctrl-C and signals. [`output`]: the only place that prints. [`written_files`]: files that a user names.
//! - [`own_format`]: format and version at the head of our files. [`watch`]: spans, with `lines.rs` and `telemetry/`.

mod advice;
pub mod align;
#[cfg(all(feature = "lerobot", feature = "parquet"))]
pub mod annotate;
pub mod annotate_args;
pub mod calibrate;
pub mod calibration;
pub mod calls;
pub mod check;
#[cfg(feature = "local")]
pub mod clip;
mod command_progress;
pub mod count;
pub mod doubts;
#[cfg(feature = "local")]
pub mod download_bar;
pub mod episode_paths;
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
pub mod pairs;
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
pub mod text_language;
mod toml_message;
pub mod walk_ranking;
pub mod watch;
pub mod written_files;

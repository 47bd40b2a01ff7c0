//! Readers and writers of the field's dataset formats: R2R, REVERIE, RxR, VLN-CE and Wayword's own JSONL; tables as
//! Parquet; layouts for training.
//!
//! Files are untrusted. Sizes and counts are bounded, ids cannot name a folder, and an error names file, item and
//! field. A file is written completely or not at all.
//!
//! Architecture invariant: this crate depends on no platform, model or network.
//!
//! # Where things are
//! - `dataset_format`: the list of formats, from which `export`, `check` and `--episodes` take them; `format` tells which one a
//!   file has. Each has a file of its own, as [`r2r`];
//!   `matterport` has the fields that R2R, REVERIE and RxR share.
//! - `beginning`: what a file holds, by its first item; `file_kind`: by its first bytes, where it is no JSON.
//! - `limits`: all limits on a file. `input`, `bounded_tokens` and `strict_json` keep to them.
//! - [`jsonl`]: Wayword's own records, with their version.
//! - [`trajectories`]: walks in single actions, what cameras see along them, and shards. [`vlnce_actions`] has VLN-CE's files of them.
//! - [`training`]: the layouts that training code reads, a file for each. Those with texts about recordings are read too.
//! - [`OutputFile`]: the one writer of files that a user names; [`OutputPlace`]: whether that is a file, a pipe or standard output.
//! - `official`: the official splits of scenes.
//! - `table`, with the feature `parquet`: the columns of tables, in `schema.txt` and in `columns.rs` in the same order.
//! - [`habitat`]: where poses change between Wayword's frame and Habitat's.

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

mod beginning;
mod bounded_tokens;
mod dataset_format;
mod episode;
mod error;
mod file_kind;
mod format;
pub mod habitat;
mod heading_units;
pub mod hear_annotations;
mod input;
mod item;
mod json_fault;
pub mod jsonl;
#[cfg(feature = "parquet")]
mod leaf_column;
mod limits;
mod matterport;
mod official;
mod output;
mod output_file;
mod output_place;
pub mod r2r;
mod read_tally;
pub mod reverie;
pub mod rxr;
mod splits;
mod strict_json;
pub mod submission;
#[cfg(feature = "parquet")]
pub mod table;
pub mod text_hash;
pub mod training;
pub mod trajectories;
pub mod vlnce;
pub mod vlnce_actions;
mod vocabulary;

pub use dataset_format::{DatasetFormat, UnknownFormat};
pub use episode::{Episode, InHabitat};
pub use error::{FormatError, ItemPlace, WrongItem, disk_advice};
pub use format::{detect_format, file_in_dataset, read_any_format};
pub(crate) use item::DatasetItem;
pub use official::OfficialSplit;
pub use output::write_sidecar;
pub use output_file::OutputFile;
pub use output_place::OutputPlace;
pub use splits::split_by_scene;
pub use vocabulary::TokenVocabulary;

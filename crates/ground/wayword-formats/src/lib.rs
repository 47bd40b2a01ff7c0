//! Readers and writers of the field's dataset formats: R2R, REVERIE, RxR, VLN-CE and Wayword's own JSONL; tables as
//! Parquet.
//!
//! Files are untrusted. Sizes and counts are bounded, ids cannot name a folder, and an error names file, item and
//! field. A file is written completely or not at all.
//!
//! Architecture invariant: this crate depends on no platform, model or network.

mod bounded_tokens;
mod episode;
mod error;
mod format;
pub mod habitat;
pub mod hear_annotations;
mod input;
mod item;
pub mod jsonl;
mod limits;
mod matterport;
mod official;
mod output;
pub mod r2r;
mod read_tally;
pub mod reverie;
pub mod rxr;
mod splits;
mod strict_json;
pub mod submission;
#[cfg(feature = "parquet")]
pub mod table;
pub mod trajectories;
pub mod vlnce;
pub mod vlnce_actions;
mod vocabulary;

pub use episode::{Episode, InHabitat};
pub use error::{FormatError, ItemPlace, WrongItem};
pub use format::{DatasetFormat, UnknownFormat, detect_format, read_any_format};
pub(crate) use item::DatasetItem;
pub use official::OfficialSplit;
pub use output::write_sidecar;
pub use splits::split_by_scene;
pub use vocabulary::TokenVocabulary;

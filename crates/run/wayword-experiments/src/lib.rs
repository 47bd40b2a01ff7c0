//! The commands that judge instructions by experiment: agents that walk by them (`compare`, `evaluate`), changed worlds
//! (`robustness`), captions against labels (`perceive`), text metrics (`similarity`), and studies with people (`study`).
//!
//! # Where things are
//! - `compare/agents.rs`, `thresholds.rs`, `grounders.rs`, `tools.rs`: the agents with their thresholds and grounders by name, and the
//!   model and eyes of the agent `tools`.
//! - [`judge`], [`demands`]: how a submission is held against the episodes. `evaluate/figures.rs` shows its figures.
//! - `robustness/arm.rs`, `write_texts.rs`, `record.rs`: the arms of a run, and the records of their texts; `eye.rs` is `--eye`.
//! - `robustness/other_platform/`: the same poses on another platform, and the houses and films that are saved for it.
//! - `similarity/metrics.rs`, `pictures.rs`: `--metrics` and `--clip`; [`by_pictures`]: the pictures and texts that a CLIP scores.
//!   [`encoder`]: models that compare texts.
//! - `perceive/detector.rs`: how a detector is measured.
//! - `study/candidates.rs`, `choose_paths.rs`, `corrupted.rs`, `marks.rs`: the paths, texts and marked words of a study; `pictures.rs`,
//!   `ground_survey.rs`: its pictures, and how well its graphs stand for the ground.

pub mod by_pictures;
pub mod compare;
pub mod demands;
pub mod encoder;
pub mod episodes;
pub mod evaluate;
pub mod judge;
pub mod perceive;
pub mod robustness;
pub mod similarity;
#[cfg(feature = "study")]
pub mod study;
pub mod study_args;
pub mod text_sets;

//! The commands that judge instructions by experiment: agents that walk by them (`compare`, `evaluate`), changed worlds
//! (`robustness`), captions against labels (`perceive`), text metrics (`similarity`), and studies with people (`study`).

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

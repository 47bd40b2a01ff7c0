//! BLIP (arXiv 2201.12086), as transformers' `BlipForConditionalGeneration` and `BlipForQuestionAnswering` have it.

mod caption;
mod config;
mod decoder;
mod picture_cache;
mod text;
mod vision;
mod vqa;

pub use caption::BlipCaptioner;
pub use vqa::BlipVqa;

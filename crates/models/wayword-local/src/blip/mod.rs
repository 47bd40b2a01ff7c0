//! BLIP (arXiv 2201.12086), as in transformers' `BlipForConditionalGeneration` and `BlipForQuestionAnswering`.

mod caption;
mod config;
mod decoder;
#[cfg(test)]
mod tests;
mod text;
mod vision;
mod vqa;

pub use caption::BlipCaptioner;
pub(crate) use config::VisionConfig;
pub(crate) use vision::BlipVision;
pub use vqa::BlipVqa;

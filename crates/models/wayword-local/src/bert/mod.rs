//! BERT: sentence encoders with its architecture, such as all-MiniLM-L6-v2, and the text towers of other models.

mod config;
mod encoder;
mod sentences;

pub(crate) use config::{Config, Sizes};
pub(crate) use encoder::{Encoder, Layer};
pub use sentences::SentenceEncoder;

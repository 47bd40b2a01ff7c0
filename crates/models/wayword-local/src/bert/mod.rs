//! Sentence encoders with BERT's architecture, such as all-MiniLM-L6-v2.

mod config;
mod encoder;
mod sentences;

pub(crate) use config::{Config, Sizes};
pub(crate) use encoder::{Encoder, Layer};
pub use sentences::SentenceEncoder;

//! Sentence encoders with BERT's architecture, such as all-MiniLM-L6-v2.

mod config;
mod encoder;
mod sentences;

pub use sentences::SentenceEncoder;

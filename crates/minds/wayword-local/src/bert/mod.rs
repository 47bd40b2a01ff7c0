//! Sentence encoders of BERT's shape: all-MiniLM-L6-v2 and its like.

mod config;
mod encoder;
mod sentences;

pub use sentences::SentenceEncoder;

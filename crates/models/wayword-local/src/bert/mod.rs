//! BERT: sentence encoders with its architecture (all-MiniLM-L6-v2, for example), and the text encoders of GLIP and
//! Grounding DINO.

mod config;
mod encoder;
mod sentences;

pub(crate) use config::{Config, Sizes};
pub(crate) use encoder::{Encoder, Layer};
pub use sentences::SentenceEncoder;

//! BERT: sentence encoders with its architecture (all-MiniLM-L6-v2, for example), and the text encoders of GLIP and
//! Grounding DINO.

mod config;
mod encoder;
mod modules;
mod sentences;

pub(crate) use config::{BertConfig, BertSizes};
pub(crate) use encoder::{BertEncoder, BertLayer};
pub use sentences::SentenceEncoder;

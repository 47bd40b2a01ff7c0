//! The roles of asking, seeing, summing up and writing, played by a language model with our prompts.
//!
//! Perception draws with a seed of its own, the same in every run: a view that was talked about once is not paid for again.

mod answerer;
mod asker;
mod clean;
mod summariser;
mod writer;

use wayword_core::{LanguageModel, Message, ModelError, Reply, Request, Sampling};

pub use answerer::ModelAnswerer;
pub use asker::ModelAsker;
pub use summariser::ModelSummariser;
pub use writer::ModelWriter;

/// Seed of every draw that belongs to perception.
const PERCEPTION_SEED: u64 = 0;

/// Puts one message to a model.
fn say(model: &dyn LanguageModel, message: Message, sampling: Sampling) -> Result<Reply, ModelError> {
    let request = Request { messages: vec![message], sampling, replicate: 0 };
    let nothing = || ModelError::Failed {
        model: model.name().to_owned(),
        reason: "it gave no result for the request".to_owned(),
    };
    model.complete(&[request]).pop().unwrap_or_else(|| Err(nothing()))
}

#[cfg(test)]
pub(crate) mod tests;

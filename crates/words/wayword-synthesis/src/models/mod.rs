//! The roles of asking, seeing, summarising and writing, played by a language model with our prompts.
//!
//! Calls about views use the same seed in every run, so that the ledger has the answers about a view that was already
//! paid for.

mod answerer;
mod asker;
mod summariser;
mod writer;

use wayword_core::{ChatMessage, LanguageModel, ModelError, ModelReply, ModelRequest, SamplingOptions};

pub use answerer::ModelAnswerer;
pub use asker::ModelAsker;
pub use summariser::ModelSummariser;
pub use writer::ModelWriter;

/// Seed of every call about a view.
const PERCEPTION_SEED: u64 = 0;

/// Sends one message to a model.
fn send_message(
    model: &dyn LanguageModel,
    message: ChatMessage,
    sampling: SamplingOptions,
) -> Result<ModelReply, ModelError> {
    let request = ModelRequest { messages: vec![message], sampling, replicate: 0, schema: None, tools: &[] };
    let nothing = || ModelError::Failed {
        model: model.name().to_owned(),
        reason: "it gave no result for the request".to_owned(),
    };
    model.complete_requests(&[request]).pop().unwrap_or_else(|| Err(nothing()))
}

#[cfg(test)]
pub(crate) mod tests;

//! A language model that writes instructions.

use super::{clean::plain, say};
use crate::{
    prompts::Prompts,
    writer::{Brief, WriteError, Writer},
};
use std::sync::Arc;
use wayword_core::{Finish, LanguageModel, Message, ModelError, Sampling};

/// Has a language model write. What was wrong with earlier texts stands in its prompt.
#[derive(Clone)]
pub struct ModelWriter {
    model: Arc<dyn LanguageModel>,
    prompts: Arc<Prompts>,
}

/// Warm enough that texts differ in their wording.
const TEMPERATURE: f64 = 0.7;
/// Room for the longest instruction of a fine-grained style.
const MAX_TOKENS: u32 = 300;

impl ModelWriter {
    /// A writer behind a model.
    #[must_use]
    pub fn new(model: Arc<dyn LanguageModel>, prompts: Arc<Prompts>) -> Self {
        Self { model, prompts }
    }
}

impl Writer for ModelWriter {
    fn name(&self) -> &str {
        self.model.name()
    }

    fn write(&self, brief: &Brief<'_>) -> Result<String, WriteError> {
        let prompt = self.prompts.write(brief).map_err(ModelError::from)?;
        let sampling = Sampling { temperature: TEMPERATURE, max_tokens: MAX_TOKENS, seed: brief.seed };
        let reply = say(self.model.as_ref(), Message::user(prompt), sampling)?;
        let text = plain(&reply.text, &["instruction"]);
        match reply.finish {
            Finish::Stop if text.is_empty() => Err(WriteError::Unusable { text, reason: "it was empty" }),
            Finish::Stop => Ok(text),
            Finish::Length => Err(WriteError::Unusable { text, reason: "it was cut off: write a shorter text" }),
        }
    }
}

//! A language model that writes instructions.

use super::{chatter::refuses, clean::plain, say};
use crate::{
    prompts::Prompts,
    writer::{Brief, WriteError, Writer},
};
use std::sync::Arc;
use wayword_core::{Finish, LONGEST_TEXT_BYTES, LanguageModel, Message, ModelError, Sampling};

/// Lets a language model write. Its prompt includes the reasons why earlier texts failed.
#[derive(Clone)]
pub struct ModelWriter {
    model: Arc<dyn LanguageModel>,
    prompts: Arc<Prompts>,
}

/// Warm enough that texts differ in their wording.
const TEMPERATURE: f64 = 0.7;
/// Room for the longest instruction of a fine-grained style.
const MAX_TOKENS: u32 = 300;
/// How much of an over-long text the next prompt shows, bytes.
const SHOWN_BYTES: usize = 500;

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
        let pictures = brief.pictures.iter().map(|picture| Arc::clone(&picture.image)).collect();
        let seed = brief.seed.wrapping_add(u64::from(brief.candidate));
        let sampling = Sampling { temperature: TEMPERATURE, max_tokens: MAX_TOKENS, seed };
        let reply = say(self.model.as_ref(), Message::about(prompt, pictures), sampling)?;
        let text = plain(&reply.text, &["instruction"]);
        if text.len() > LONGEST_TEXT_BYTES {
            let reason = format!("it has {} bytes, more than {LONGEST_TEXT_BYTES}: write a few sentences", text.len());
            let text = format!("{} ...", &text[..text.floor_char_boundary(SHOWN_BYTES)]);
            return Err(WriteError::Unusable { text, reason });
        }
        let unusable = |reason: &str| Err(WriteError::Unusable { text: text.clone(), reason: reason.to_owned() });
        match reply.finish {
            _ if refuses(&text) => unusable("it refused instead of giving directions: write the instruction itself"),
            Finish::Stop if text.is_empty() => unusable("it was empty"),
            Finish::Stop => Ok(text),
            Finish::Length => unusable("it was cut off: write a shorter text"),
        }
    }
}

//! A language model that writes instructions.

use super::{chatter::is_refusal, plain_text::plain_text, send_message};
use crate::{
    prompts::Prompts,
    writer::{InstructionWriter, WriteError, WritingBrief},
};
use std::sync::Arc;
use wayword_core::{ChatMessage, FinishReason, LanguageModel, MAX_TEXT_BYTES, ModelError, SamplingOptions};

/// Lets a language model write. Its prompt includes the reasons why earlier texts failed.
#[derive(Clone)]
pub struct ModelWriter {
    model: Arc<dyn LanguageModel>,
    prompts: Arc<Prompts>,
}

/// Warm enough that texts differ in their wording.
const WRITING_TEMPERATURE: f64 = 0.7;
/// Room for the longest instruction of a fine-grained style.
const MAX_TOKENS: u32 = 300;
/// How much of an over-long text the next prompt shows, bytes.
const MAX_SHOWN_BYTES: usize = 500;

impl ModelWriter {
    /// A writer behind a model.
    #[must_use]
    pub fn new(model: Arc<dyn LanguageModel>, prompts: Arc<Prompts>) -> Self {
        Self { model, prompts }
    }
}

impl InstructionWriter for ModelWriter {
    fn name(&self) -> &str {
        self.model.name()
    }

    fn write(&self, brief: &WritingBrief<'_>) -> Result<String, WriteError> {
        let prompt = self.prompts.writing_prompt(brief).map_err(ModelError::from)?;
        let pictures = brief.pictures.iter().map(|picture| Arc::clone(&picture.image)).collect();
        let seed = brief.seed.wrapping_add(u64::from(brief.candidate));
        let sampling = SamplingOptions { temperature: WRITING_TEMPERATURE, max_tokens: MAX_TOKENS, seed };
        let reply = send_message(self.model.as_ref(), ChatMessage::about_images(prompt, pictures), sampling)?;
        let text = plain_text(&reply.text, &["instruction"]);
        if text.len() > MAX_TEXT_BYTES {
            let reason = format!("it has {} bytes, more than {MAX_TEXT_BYTES}: write a few sentences", text.len());
            let text = format!("{} ...", &text[..text.floor_char_boundary(MAX_SHOWN_BYTES)]);
            return Err(WriteError::Unusable { text, reason });
        }
        let unusable = |reason: &str| Err(WriteError::Unusable { text: text.clone(), reason: reason.to_owned() });
        match reply.finish {
            _ if is_refusal(&text) => unusable("it refused instead of giving directions: write the instruction itself"),
            FinishReason::Stop if text.is_empty() => unusable("it was empty"),
            FinishReason::Stop => Ok(text),
            FinishReason::Length => unusable("it was cut off: write a shorter text"),
        }
    }
}

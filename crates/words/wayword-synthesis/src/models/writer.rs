//! A language model that writes instructions.

use super::send_message;
use crate::{
    prompts::Prompts,
    writer::{InstructionWriter, WriteError, WritingBrief},
};
use std::sync::Arc;
use wayword_core::{ChatMessage, FinishReason, LanguageModel, MAX_TEXT_BYTES, ModelError, SamplingOptions};
use wayword_language::Language;
use wayword_replies::{is_refusal, read_text, read_text_in};

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
/// Bytes of a prompt for each token of the context that a model has: fewer than English text has, so that the prompt surely fits.
const BYTES_PER_TOKEN: usize = 3;
/// What models call the text before it.
const TEXT_LABELS: [&str; 3] = ["instruction", "answer", "final answer"];
/// How much of an over-long text the next prompt shows, bytes.
const MAX_SHOWN_BYTES: usize = 500;

/// The name of the language that a text has to be in, if that is not English.
fn written_language(brief: &WritingBrief<'_>) -> Option<&'static str> {
    let tag = brief.profile.language.as_ref()?.tag();
    Language::from_tag(tag).foreign_name()
}

impl ModelWriter {
    /// A writer behind a model.
    #[must_use]
    pub fn new(model: Arc<dyn LanguageModel>, prompts: Arc<Prompts>) -> Self {
        Self { model, prompts }
    }

    /// The prompt, shortened for a model that reads little.
    fn fitting_prompt(&self, brief: &WritingBrief<'_>) -> Result<String, ModelError> {
        let Some(context) = self.model.context_tokens() else { return Ok(self.prompts.writing_prompt(brief)?) };
        let room_tokens = context.saturating_sub(u64::from(MAX_TOKENS));
        let most_bytes = usize::try_from(room_tokens).unwrap_or(usize::MAX).saturating_mul(BYTES_PER_TOKEN);
        let (prompt, is_shortened) = self.prompts.writing_prompt_within(brief, most_bytes)?;
        if is_shortened {
            self.model.note(format!(
                "{} reads {context} tokens, so prompts to write tell it less than is known of some walks",
                self.model.name()
            ));
        }
        Ok(prompt)
    }
}

impl InstructionWriter for ModelWriter {
    fn name(&self) -> &str {
        self.model.name()
    }

    fn write(&self, brief: &WritingBrief<'_>) -> Result<String, WriteError> {
        let prompt = self.fitting_prompt(brief)?;
        let pictures = brief.pictures.iter().map(|picture| Arc::clone(&picture.image)).collect();
        let seed = brief.seed.wrapping_add(u64::from(brief.candidate));
        let sampling = SamplingOptions { temperature: WRITING_TEMPERATURE, max_tokens: MAX_TOKENS, seed };
        let reply = send_message(self.model.as_ref(), ChatMessage::about_images(prompt, pictures), sampling)?;
        let unusable = |text: &str, reason: String| {
            // The next prompt shows only the beginning of a long reply.
            let end = text.floor_char_boundary(MAX_SHOWN_BYTES);
            let text = if end < text.len() { format!("{} ...", &text[..end]) } else { text.to_owned() };
            Err(WriteError::Unusable { text, reason })
        };
        let read = match written_language(brief) {
            Some(language) => read_text_in(language, &reply.text, &TEXT_LABELS),
            None => read_text(&reply.text, &TEXT_LABELS),
        };
        let text = read.as_deref().unwrap_or(reply.text.trim());
        if text.len() > MAX_TEXT_BYTES {
            let reason = format!("it has {} bytes, more than {MAX_TEXT_BYTES}: write a few sentences", text.len());
            return unusable(text, reason);
        }
        match (reply.finish, &read) {
            _ if is_refusal(text) => {
                unusable(text, "it refused instead of giving directions: write the instruction itself".to_owned())
            }
            (FinishReason::Length, _) => unusable(text, "it was cut off: write a shorter text".to_owned()),
            (FinishReason::Stop, Err(fault)) => unusable(text, fault.clone()),
            (FinishReason::Stop, Ok(text)) if text.is_empty() => unusable("", "it was empty".to_owned()),
            (FinishReason::Stop, Ok(text)) => Ok(text.clone()),
        }
    }
}

//! A language model that chooses the questions.

use super::{PERCEPTION_SEED, send_message};
use crate::{dialogue::QuestionAsker, prompts::Prompts};
use std::sync::Arc;
use wayword_core::{ChatMessage, DialogueExchange, LanguageModel, ModelError, SamplingOptions};
use wayword_replies::{without_template_marks, without_thinking};

/// Lets a language model choose the questions. The dialogue extracts the question from its reply.
#[derive(Clone)]
pub struct ModelAsker {
    model: Arc<dyn LanguageModel>,
    prompts: Arc<Prompts>,
}

/// As in ChatCaptioner, temperature 0.6, so that questions differ from frame to frame. ChatCaptioner's 30 tokens cut
/// long questions off; 60 do not.
const QUESTION_SAMPLING: SamplingOptions = SamplingOptions { temperature: 0.6, max_tokens: 60, seed: PERCEPTION_SEED };

impl ModelAsker {
    /// An asker behind a model.
    #[must_use]
    pub fn new(model: Arc<dyn LanguageModel>, prompts: Arc<Prompts>) -> Self {
        Self { model, prompts }
    }
}

impl QuestionAsker for ModelAsker {
    fn name(&self) -> &str {
        self.model.name()
    }

    fn next_question(&self, transcript: &[DialogueExchange]) -> Result<Option<String>, ModelError> {
        let prompt = self.prompts.question_prompt(transcript)?;
        let reply = send_message(self.model.as_ref(), ChatMessage::from_user(prompt), QUESTION_SAMPLING)?;
        Ok(Some(without_template_marks(&without_thinking(&reply.text))))
    }
}

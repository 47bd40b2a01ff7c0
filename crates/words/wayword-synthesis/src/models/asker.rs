//! A language model that chooses the questions.

use super::{PERCEPTION_SEED, say};
use crate::{dialogue::Asker, prompts::Prompts};
use std::sync::Arc;
use wayword_core::{Exchange, LanguageModel, Message, ModelError, Sampling};

/// Lets a language model choose the questions. The dialogue extracts the question from its reply.
#[derive(Clone)]
pub struct ModelAsker {
    model: Arc<dyn LanguageModel>,
    prompts: Arc<Prompts>,
}

/// As in ChatCaptioner, temperature 0.6, so that questions differ from frame to frame. ChatCaptioner's 30 tokens cut
/// long questions off; 60 do not.
const SAMPLING: Sampling = Sampling { temperature: 0.6, max_tokens: 60, seed: PERCEPTION_SEED };

impl ModelAsker {
    /// An asker behind a model.
    #[must_use]
    pub fn new(model: Arc<dyn LanguageModel>, prompts: Arc<Prompts>) -> Self {
        Self { model, prompts }
    }
}

impl Asker for ModelAsker {
    fn name(&self) -> &str {
        self.model.name()
    }

    fn next_question(&self, transcript: &[Exchange]) -> Result<Option<String>, ModelError> {
        let prompt = self.prompts.question(transcript)?;
        let reply = say(self.model.as_ref(), Message::user(prompt), SAMPLING)?;
        Ok(Some(reply.text))
    }
}

//! A language model that sees.

use super::{PERCEPTION_SEED, clean::whole_sentences};
use crate::{
    prompts::{Manner, Prompts},
    seeing::complaint,
};
use std::sync::Arc;
use wayword_core::{Answer, AnswerForm, Answerer, Ask, LanguageModel, Message, ModelError, Request, Sampling};

/// Puts questions about a view's picture to a language model that sees.
#[derive(Clone)]
pub struct ModelAnswerer {
    model: Arc<dyn LanguageModel>,
    prompts: Arc<Prompts>,
    manner: Manner,
}

/// The likeliest answer, because what is in a picture does not change with a random draw.
const SAMPLING: Sampling = Sampling { temperature: 0.0, max_tokens: 160, seed: PERCEPTION_SEED };

/// Room for the JSON of about twenty things.
const OF_JSON: Sampling = Sampling { max_tokens: 1_000, ..SAMPLING };

impl ModelAnswerer {
    /// An answerer that asks a model, with prompts of the form that it expects.
    #[must_use]
    pub fn new(model: Arc<dyn LanguageModel>, prompts: Arc<Prompts>, manner: Manner) -> Self {
        Self { model, prompts, manner }
    }

    fn request(&self, ask: &Ask<'_>) -> Result<Request, ModelError> {
        let image = ask.view.image.clone().ok_or_else(|| ModelError::NothingToSee {
            name: self.model.name().to_owned(),
            needs: "a picture",
            hint: "use a platform or data folder with pictures, or `--see labels` where there are labels",
        })?;
        let (text, sampling, schema) = match ask.answer {
            AnswerForm::Words => (self.prompts.answer(self.manner, ask.question, ask.history)?, SAMPLING, None),
            AnswerForm::Json(schema) => (self.prompts.see(complaint(ask.question))?, OF_JSON, Some(schema)),
        };
        let message = Message::about(text, vec![image]);
        Ok(Request { messages: vec![message], sampling, replicate: 0, schema })
    }
}

impl Answerer for ModelAnswerer {
    fn name(&self) -> &str {
        self.model.name()
    }

    fn answer(&self, asks: &[Ask<'_>]) -> Vec<Result<Answer, ModelError>> {
        let requests: Vec<Result<Request, ModelError>> = asks.iter().map(|ask| self.request(ask)).collect();
        let good: Vec<Request> = requests.iter().filter_map(|request| request.as_ref().ok().cloned()).collect();
        let mut replies = self.model.complete(&good).into_iter();
        let lost = || ModelError::Failed { model: self.name().to_owned(), reason: "it gave no answer".to_owned() };
        let answer = |request: Result<Request, ModelError>| {
            let is_json = request?.schema.is_some();
            let reply = replies.next().unwrap_or_else(|| Err(lost()))?;
            Ok(if is_json { reply.text } else { whole_sentences(&reply).to_owned() })
        };
        requests.into_iter().map(answer).collect()
    }
}

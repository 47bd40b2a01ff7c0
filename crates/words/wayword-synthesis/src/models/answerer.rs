//! A vision-language model as the answerer.

use super::PERCEPTION_SEED;
use crate::{
    dialogue::rephrase_question,
    prompts::{PromptManner, Prompts},
    seeing::complaint_in_question,
};
use std::sync::Arc;
use wayword_core::{
    AnswerForm, AnswerText, ChatMessage, FinishReason, LanguageModel, ModelError, ModelReply, ModelRequest,
    SamplingOptions, ViewAnswerer, ViewQuestion,
};
use wayword_replies::read_sentences;

/// Puts questions about a view's picture to a vision-language model. An answer in words that was cut off is asked for
/// once more, shorter; from the second one the whole sentences are taken. The caller handles refusals and JSON that was
/// cut off.
#[derive(Clone)]
pub struct ModelAnswerer {
    model: Arc<dyn LanguageModel>,
    prompts: Arc<Prompts>,
    manner: PromptManner,
}

/// Temperature 0: the content of a picture does not depend on a random draw.
const ANSWER_SAMPLING: SamplingOptions = SamplingOptions { temperature: 0.0, max_tokens: 160, seed: PERCEPTION_SEED };

/// Enough tokens for the JSON of about twenty things.
const JSON_SAMPLING: SamplingOptions = SamplingOptions { max_tokens: 1_000, ..ANSWER_SAMPLING };

impl ModelAnswerer {
    /// An answerer that asks a model, with prompts of the form that it expects.
    #[must_use]
    pub fn new(model: Arc<dyn LanguageModel>, prompts: Arc<Prompts>, manner: PromptManner) -> Self {
        Self { model, prompts, manner }
    }

    fn build_request(&self, ask: &ViewQuestion<'_>) -> Result<ModelRequest, ModelError> {
        let image = ask.view.image.clone().ok_or_else(|| ModelError::NothingToSee {
            name: self.model.name().to_owned(),
            needs: "a picture",
            hint: "use a platform or data folder with pictures, or `--see labels` where there are labels",
        })?;
        let (text, sampling, schema) = match ask.answer {
            AnswerForm::Words => {
                (self.prompts.answer_prompt(self.manner, ask.question, ask.history)?, ANSWER_SAMPLING, None)
            }
            AnswerForm::Json(schema) => {
                (self.prompts.view_prompt(complaint_in_question(ask.question))?, JSON_SAMPLING, Some(schema))
            }
        };
        let message = ChatMessage::about_images(text, vec![image]);
        Ok(ModelRequest { messages: vec![message], sampling, replicate: 0, schema, tools: &[] })
    }

    /// One reply per question, in their order.
    fn request_replies(&self, asks: &[ViewQuestion<'_>]) -> Vec<Result<ModelReply, ModelError>> {
        let requests: Vec<Result<ModelRequest, ModelError>> = asks.iter().map(|ask| self.build_request(ask)).collect();
        let good: Vec<ModelRequest> = requests.iter().filter_map(|request| request.as_ref().ok().cloned()).collect();
        let mut replies = if good.is_empty() { Vec::new() } else { self.model.complete_requests(&good) }.into_iter();
        let lost = || ModelError::Failed { model: self.name().to_owned(), reason: "it gave no answer".to_owned() };
        // Only requests that could be built were sent, so only they take the next reply.
        let reply = |request: Result<ModelRequest, ModelError>| {
            request?;
            replies.next().unwrap_or_else(|| Err(lost()))
        };
        requests.into_iter().map(reply).collect()
    }
}

impl ViewAnswerer for ModelAnswerer {
    fn name(&self) -> &str {
        self.model.name()
    }

    fn answer_questions(&self, asks: &[ViewQuestion<'_>]) -> Vec<Result<AnswerText, ModelError>> {
        let mut replies = self.request_replies(asks);
        let is_cut = |(ask, reply): (&ViewQuestion<'_>, &Result<ModelReply, ModelError>)| {
            ask.answer == AnswerForm::Words && reply.as_ref().is_ok_and(|reply| reply.finish == FinishReason::Length)
        };
        let cut: Vec<usize> = (0..asks.len()).filter(|&at| is_cut((&asks[at], &replies[at]))).collect();
        let shorter: Vec<String> = cut.iter().map(|&at| rephrase_question(asks[at].question)).collect();
        let again: Vec<ViewQuestion<'_>> =
            cut.iter().zip(&shorter).map(|(&at, question)| ViewQuestion { question, ..asks[at] }).collect();
        for (&at, reply) in cut.iter().zip(self.request_replies(&again)) {
            replies[at] = reply;
        }
        let text = |(reply, ask): (Result<ModelReply, ModelError>, &ViewQuestion<'_>)| {
            reply.map(|reply| match ask.answer {
                AnswerForm::Words => read_sentences(&reply),
                AnswerForm::Json(_) => reply.text,
            })
        };
        replies.into_iter().zip(asks).map(text).collect()
    }
}

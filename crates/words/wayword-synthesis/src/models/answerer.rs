//! A vision-language model as the answerer.

use super::{PERCEPTION_SEED, clean::whole_sentences};
use crate::{
    dialogue::rephrased,
    prompts::{Manner, Prompts},
    seeing::complaint,
};
use std::sync::Arc;
use wayword_core::{
    Answer, AnswerForm, Answerer, Ask, Finish, LanguageModel, Message, ModelError, Reply, Request, Sampling,
};

/// Puts questions about a view's picture to a vision-language model. An answer in words that was cut off is asked for
/// once more, shorter; from the second one the whole sentences are taken. The caller handles refusals and JSON that was
/// cut off.
#[derive(Clone)]
pub struct ModelAnswerer {
    model: Arc<dyn LanguageModel>,
    prompts: Arc<Prompts>,
    manner: Manner,
}

/// Temperature 0: the content of a picture does not depend on a random draw.
const SAMPLING: Sampling = Sampling { temperature: 0.0, max_tokens: 160, seed: PERCEPTION_SEED };

/// Enough tokens for the JSON of about twenty things.
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
        Ok(Request { messages: vec![message], sampling, replicate: 0, schema, tools: &[] })
    }

    /// One reply per question, in their order.
    fn replies(&self, asks: &[Ask<'_>]) -> Vec<Result<Reply, ModelError>> {
        let requests: Vec<Result<Request, ModelError>> = asks.iter().map(|ask| self.request(ask)).collect();
        let good: Vec<Request> = requests.iter().filter_map(|request| request.as_ref().ok().cloned()).collect();
        let mut replies = if good.is_empty() { Vec::new() } else { self.model.complete(&good) }.into_iter();
        let lost = || ModelError::Failed { model: self.name().to_owned(), reason: "it gave no answer".to_owned() };
        let reply = |request: Result<Request, ModelError>| {
            request?;
            replies.next().unwrap_or_else(|| Err(lost()))
        };
        requests.into_iter().map(reply).collect()
    }
}

impl Answerer for ModelAnswerer {
    fn name(&self) -> &str {
        self.model.name()
    }

    fn answer(&self, asks: &[Ask<'_>]) -> Vec<Result<Answer, ModelError>> {
        let mut replies = self.replies(asks);
        let is_cut = |(ask, reply): (&Ask<'_>, &Result<Reply, ModelError>)| {
            ask.answer == AnswerForm::Words && reply.as_ref().is_ok_and(|reply| reply.finish == Finish::Length)
        };
        let cut: Vec<usize> = (0..asks.len()).filter(|&at| is_cut((&asks[at], &replies[at]))).collect();
        let shorter: Vec<String> = cut.iter().map(|&at| rephrased(asks[at].question)).collect();
        let again: Vec<Ask<'_>> =
            cut.iter().zip(&shorter).map(|(&at, question)| Ask { question, ..asks[at] }).collect();
        for (&at, reply) in cut.iter().zip(self.replies(&again)) {
            replies[at] = reply;
        }
        let text = |(reply, ask): (Result<Reply, ModelError>, &Ask<'_>)| {
            reply.map(|reply| match ask.answer {
                AnswerForm::Words => whole_sentences(&reply).to_owned(),
                AnswerForm::Json(_) => reply.text,
            })
        };
        replies.into_iter().zip(asks).map(text).collect()
    }
}

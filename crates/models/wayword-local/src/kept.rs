//! Calls of a model in process, each made once and kept in the ledger, because they cost minutes, although no money.

use crate::{EyeKind, LocalError, eyes::Eye, picture::digest};
use serde_json::{Value, json};
use std::{
    sync::{Arc, Mutex, PoisonError},
    time::Instant,
};
use wayword_core::{Finish, Image, LanguageModel, Message, ModelError, Reply, Request};
use wayword_ledger::{Answer, Call, OnceError, Refused, Run};

/// A model in process behind the ledger.
pub struct LocalModel {
    /// `hf/ORG/NAME`.
    name: String,
    /// The identity of the weights and their precision, which could change an answer too.
    origin: String,
    eye: Arc<dyn Eye>,
    /// Held during a call: each call uses all threads, and two at once would need twice the memory.
    turn: Mutex<()>,
    run: Run,
}

/// Why a call was not answered.
#[derive(Debug, thiserror::Error)]
enum Unanswered {
    #[error(transparent)]
    Failed(LocalError),
    #[error(transparent)]
    Refused(Refused),
}

impl LocalModel {
    pub(crate) fn new(name: &str, origin: String, eye: Arc<dyn Eye>, run: Run) -> Self {
        Self { name: name.to_owned(), origin, eye, turn: Mutex::new(()), run }
    }

    /// The form of request that it takes.
    #[must_use]
    pub fn kind(&self) -> EyeKind {
        self.eye.kind()
    }

    /// The identity of its weights, and their precision.
    #[must_use]
    pub fn origin(&self) -> &str {
        &self.origin
    }

    fn one(&self, request: &Request) -> Result<Reply, ModelError> {
        let asked = self.run.once(&self.call(request), |attempts| {
            let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
            attempts.begin(Some(0.0)).map_err(Unanswered::Refused)?;
            let begun = Instant::now();
            let text = self.eye.reply(request).map_err(Unanswered::Failed)?;
            Ok(answer(text, begun))
        });
        asked.map(reply).map_err(|error| self.error(error))
    }

    /// The call for the ledger.
    fn call(&self, request: &Request) -> Call {
        let message = |message: &Message| {
            let picture = message.images.first().map(|image| hash(image));
            json!({ "role": message.role, "text": message.text, "image_sha256": picture })
        };
        let messages: Vec<Value> = request.messages.iter().map(message).collect();
        let sampling = &request.sampling;
        let request_json = json!({
            "messages": messages,
            "temperature": sampling.temperature,
            "max_tokens": sampling.max_tokens,
            "seed": sampling.seed,
        });
        Call {
            model: self.name.clone(),
            base_url: self.origin.clone(),
            request: request_json,
            replicate: request.replicate,
        }
    }

    fn error(&self, error: OnceError<Unanswered>) -> ModelError {
        let failed = |reason: String| ModelError::Failed { model: self.name.clone(), reason };
        let refused = match error {
            OnceError::Call(Unanswered::Failed(error)) => return failed(error.to_string()),
            OnceError::Call(Unanswered::Refused(refused)) | OnceError::Refused(refused) => refused,
            OnceError::Ledger(error) => Refused::Ledger(error),
            // The item also failed when the recording was made.
            missing @ OnceError::NotRecorded { .. } => {
                return failed(missing.to_string().lines().next().unwrap_or("not recorded").to_owned());
            }
        };
        let is_lost = refused.is_lost();
        let (reason, hint) = refused.told();
        ModelError::Stopped { reason, hint, is_lost }
    }
}

impl LanguageModel for LocalModel {
    fn name(&self) -> &str {
        &self.name
    }

    fn complete(&self, requests: &[Request]) -> Vec<Result<Reply, ModelError>> {
        requests.iter().map(|request| self.one(request)).collect()
    }
}

/// Tokens are not counted, because they cost nothing here.
fn answer(text: String, begun: Instant) -> Answer {
    Answer {
        text,
        finish: "stop".to_owned(),
        tokens_in: 0,
        tokens_out: 0,
        usd: Some(0.0),
        latency_ms: u64::try_from(begun.elapsed().as_millis()).unwrap_or(u64::MAX),
        attempts: 1,
    }
}

fn reply(answer: Answer) -> Reply {
    let finish = if answer.finish == "length" { Finish::Length } else { Finish::Stop };
    Reply { text: answer.text, finish }
}

/// A picture's name in the ledger.
fn hash(image: &Image) -> String {
    digest(image).iter().map(|byte| format!("{byte:02x}")).collect()
}

//! Makes each call of an in-process model once, and keeps its answer in the ledger. A call costs no money, but it may
//! cost minutes.

use crate::{EyeKind, eyes::Eye, picture::digest};
use serde_json::{Value, json};
use std::{
    sync::{Arc, Mutex, PoisonError},
    time::Instant,
};
use wayword_core::{Finish, Image, LanguageModel, Message, ModelError, Reply, Request};
use wayword_ledger::{Answer, Call, OnceError, Refused, Run};

/// An in-process model behind the ledger: a request that was answered before gets the answer from there.
pub struct LocalModel {
    kept: Kept,
    eye: Arc<dyn Eye>,
}

/// Makes the calls of one in-process model, each once, through the ledger.
pub(crate) struct Kept {
    /// `hf/ORG/NAME`.
    pub(crate) name: String,
    /// The identity of the weights and their precision. It is part of a call's key, because it may change the answer.
    pub(crate) origin: String,
    /// Held during a call: each call uses all threads, and two at once would need twice the memory.
    turn: Mutex<()>,
    run: Run,
}

/// The reason why a call was not answered.
#[derive(Debug, thiserror::Error)]
enum Unanswered {
    #[error(transparent)]
    Failed(ModelError),
    #[error(transparent)]
    Refused(Refused),
}

impl LocalModel {
    pub(crate) fn new(name: &str, origin: String, eye: Arc<dyn Eye>, run: Run) -> Self {
        Self { kept: Kept::new(name, origin, run), eye }
    }

    /// The form of request that it takes.
    #[must_use]
    pub fn kind(&self) -> EyeKind {
        self.eye.kind()
    }

    /// The identity of the weights, and their precision.
    #[must_use]
    pub fn origin(&self) -> &str {
        &self.kept.origin
    }

    fn one(&self, request: &Request) -> Result<Reply, ModelError> {
        let answer = self.kept.once(asked(request), request.replicate, || {
            let failed = |reason| ModelError::Failed { model: self.kept.name.clone(), reason };
            self.eye.reply(request).map_err(|error| failed(error.to_string()))
        });
        answer.map(reply)
    }
}

/// The parts of a request that may change the reply. They are the key under which the ledger keeps the answer.
fn asked(request: &Request) -> Value {
    let message = |message: &Message| {
        let picture = message.images.first().map(|image| hash(image));
        json!({ "role": message.role, "text": message.text, "image_sha256": picture })
    };
    let messages: Vec<Value> = request.messages.iter().map(message).collect();
    let sampling = &request.sampling;
    json!({
        "messages": messages,
        "temperature": sampling.temperature,
        "max_tokens": sampling.max_tokens,
        "seed": sampling.seed,
    })
}

impl Kept {
    pub(crate) fn new(name: &str, origin: String, run: Run) -> Self {
        Self { name: name.to_owned(), origin, turn: Mutex::new(()), run }
    }

    /// The answer to a request: the one in the ledger, or else a computed one, which the ledger then keeps.
    pub(crate) fn once(
        &self,
        request: Value,
        replicate: u32,
        compute: impl FnOnce() -> Result<String, ModelError>,
    ) -> Result<Answer, ModelError> {
        let call = Call { model: self.name.clone(), base_url: self.origin.clone(), request, replicate };
        let asked = self.run.once(&call, |attempts| {
            let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
            attempts.begin(Some(0.0)).map_err(Unanswered::Refused)?;
            let begun = Instant::now();
            Ok(answer(compute().map_err(Unanswered::Failed)?, begun))
        });
        asked.map_err(|error| self.error(error))
    }

    fn error(&self, error: OnceError<Unanswered>) -> ModelError {
        let failed = |reason: String| ModelError::Failed { model: self.name.clone(), reason };
        let refused = match error {
            OnceError::Call(Unanswered::Failed(error)) => return error,
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
        &self.kept.name
    }

    fn complete(&self, requests: &[Request]) -> Vec<Result<Reply, ModelError>> {
        requests.iter().map(|request| self.one(request)).collect()
    }
}

/// A new answer for the ledger. Tokens are not counted, because they are free here.
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
    Reply { text: answer.text, finish, usage: None }
}

/// The hash by which the ledger refers to a picture, as hex digits.
pub(crate) fn hash(image: &Image) -> String {
    digest(image).iter().map(|byte| format!("{byte:02x}")).collect()
}

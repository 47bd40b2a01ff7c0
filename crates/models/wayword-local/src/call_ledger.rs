//! Makes each call of an in-process model once, and keeps its answer in the ledger. A call costs no money, but it may
//! cost minutes.

use crate::{EyeKind, picture::picture_digest, picture_models::PictureModel};
use serde_json::{Value, json};
use std::{
    sync::{Arc, Mutex, PoisonError},
    time::Instant,
};
use wayword_core::{ChatMessage, FinishReason, Image, LanguageModel, ModelError, ModelReply, ModelRequest, hex_text};
use wayword_ledger::{CallAnswer, LedgerRun, ModelCall, OnceError, RequestRefusedError};

/// An in-process model behind the ledger: a request that was answered before gets the answer from there.
pub struct LocalModel {
    calls: CallLedger,
    /// The model itself. An "eye" is a model that looks at pictures (the role `see`).
    eye: Arc<dyn PictureModel>,
}

/// Makes the calls of one in-process model, each once, through the ledger.
pub(crate) struct CallLedger {
    /// The model's name, `hf/ORG/NAME`.
    pub(crate) name: String,
    /// The identity of the weights and their precision. It is part of a call's key, because it may change the answer.
    pub(crate) origin: String,
    /// Locked during a call: each call uses all threads, and two at once would need twice the memory.
    call_lock: Mutex<()>,
    run: LedgerRun,
}

/// The reason why a call was not answered.
#[derive(Debug, thiserror::Error)]
enum LocalCallError {
    /// The model could not compute an answer.
    #[error(transparent)]
    Failed(ModelError),
    /// The ledger did not allow another call: a limit of the run is reached, or the ledger cannot be written.
    #[error(transparent)]
    Refused(RequestRefusedError),
}

impl LocalModel {
    pub(crate) fn new(name: &str, origin: String, eye: Arc<dyn PictureModel>, run: LedgerRun) -> Self {
        Self { calls: CallLedger::new(name, origin, run), eye }
    }

    /// The form of request that the model takes.
    #[must_use]
    pub fn kind(&self) -> EyeKind {
        self.eye.kind()
    }

    /// The identity of the weights, and their precision.
    #[must_use]
    pub fn origin(&self) -> &str {
        &self.calls.origin
    }

    /// The reply to one request, from the ledger or from the model.
    fn complete_one(&self, request: &ModelRequest) -> Result<ModelReply, ModelError> {
        let answer = self.calls.answer_once(request_json(request), request.replicate, || {
            let failed = |reason| ModelError::Failed { model: self.calls.name.clone(), reason };
            self.eye.reply_to(request).map_err(|error| failed(error.to_string()))
        });
        answer.map(reply_from_answer)
    }
}

/// The parts of a request that may change the reply. They are the key under which the ledger keeps the answer.
fn request_json(request: &ModelRequest) -> Value {
    let message = |message: &ChatMessage| {
        let picture = message.images.first().map(|image| picture_hash(image));
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

impl CallLedger {
    pub(crate) fn new(name: &str, origin: String, run: LedgerRun) -> Self {
        Self { name: name.to_owned(), origin, call_lock: Mutex::new(()), run }
    }

    /// The answer to a request: the one in the ledger, or else a computed one, which the ledger then keeps.
    pub(crate) fn answer_once(
        &self,
        request: Value,
        replicate: u32,
        compute: impl FnOnce() -> Result<String, ModelError>,
    ) -> Result<CallAnswer, ModelError> {
        let call = ModelCall { model: self.name.clone(), base_url: self.origin.clone(), request, replicate };
        let answer = self.run.answer_once(&call, |attempts| {
            let _turn = self.call_lock.lock().unwrap_or_else(PoisonError::into_inner);
            attempts.begin_request(Some(0.0)).map_err(LocalCallError::Refused)?;
            let begun = Instant::now();
            Ok(ledger_answer(compute().map_err(LocalCallError::Failed)?, begun))
        });
        answer.map_err(|error| self.to_model_error(error))
    }

    /// The error for the caller. A refusal by the ledger stops the run ([`ModelError::Stopped`]); all others concern
    /// one item.
    fn to_model_error(&self, error: OnceError<LocalCallError>) -> ModelError {
        let failed = |reason: String| ModelError::Failed { model: self.name.clone(), reason };
        let refused = match error {
            OnceError::Call(LocalCallError::Failed(error)) => return error,
            OnceError::Call(LocalCallError::Refused(refused)) | OnceError::Refused(refused) => refused,
            OnceError::Ledger(error) => RequestRefusedError::Ledger(error),
            // A replay of a recorded run has no answer only where the item also failed in the recorded run.
            missing @ OnceError::NotRecorded { .. } => {
                return failed(missing.to_string().lines().next().unwrap_or("not recorded").to_owned());
            }
        };
        let is_lost = refused.is_lost();
        let (reason, hint) = refused.reason_and_hint();
        ModelError::Stopped { reason, hint, is_lost }
    }
}

impl LanguageModel for LocalModel {
    fn name(&self) -> &str {
        &self.calls.name
    }

    fn complete_requests(&self, requests: &[ModelRequest]) -> Vec<Result<ModelReply, ModelError>> {
        requests.iter().map(|request| self.complete_one(request)).collect()
    }
}

/// A new answer for the ledger. Tokens are not counted, because they are free here.
fn ledger_answer(text: String, begun: Instant) -> CallAnswer {
    CallAnswer {
        text,
        finish: "stop".to_owned(),
        tokens_in: 0,
        tokens_out: 0,
        usd: Some(0.0),
        latency_ms: u64::try_from(begun.elapsed().as_millis()).unwrap_or(u64::MAX),
        attempts: 1,
    }
}

fn reply_from_answer(answer: CallAnswer) -> ModelReply {
    let finish = if answer.finish == "length" { FinishReason::Length } else { FinishReason::Stop };
    ModelReply { text: answer.text, finish, usage: None }
}

/// The hash by which the ledger refers to a picture, as hex digits.
pub(crate) fn picture_hash(image: &Image) -> String {
    hex_text(picture_digest(image))
}

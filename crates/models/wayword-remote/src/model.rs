//! A model behind HTTP: turns requests into calls of the ledger, makes those that the ledger has no answer for, and
//! answers batches with several threads.

use crate::{
    JsonMode, ModelPrice,
    call::{CallError, PreparedCall, RequestSize},
    dialect::{DialectRequest, RemoteMessage},
    endpoint::{ClosedEndpoint, ProviderEndpoint},
    first_calls::CallKind,
    picture::PictureEncoder,
};
use serde_json::{Map, Value, json};
use std::{
    fmt,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};
use wayword_core::{
    ChatMessage, FinishReason, LanguageModel, ModelError, ModelReply, ModelRequest, ModelTool, ModelUsage,
};
use wayword_ledger::{CallAnswer, CallContext, LedgerRun, ModelCall, OnceError, RequestRefusedError};

/// A model behind HTTP. Each of its calls is made once and kept in the ledger.
pub struct RemoteModel {
    /// `provider/model`.
    pub(crate) name: String,
    pub(crate) endpoint: Arc<ProviderEndpoint>,
    pub(crate) run: LedgerRun,
    /// Encodes the pictures of requests. All models share it.
    pub(crate) pictures: Arc<PictureEncoder>,
    pub(crate) price: Option<ModelPrice>,
    /// Most attempts per call.
    pub(crate) attempts: u32,
    /// Most threads that work on one batch.
    pub(crate) threads: usize,
}

impl RemoteModel {
    /// The price of the model, if it is known.
    #[must_use]
    pub fn price(&self) -> Option<&ModelPrice> {
        self.price.as_ref()
    }

    /// The reply to one request, from the ledger or from the service.
    fn complete_one(&self, request: &ModelRequest) -> Result<ModelReply, ModelError> {
        let lines = self.encode_messages(&request.messages).map_err(|reason| self.failed_error(reason))?;
        let call = self.ledger_call(request, &lines);
        let key = call.key();
        let answer = self.run.answer_once(&call, |attempts| {
            let dialect_request = DialectRequest {
                provider: &self.endpoint.provider,
                model: self.model_name(),
                lines: &lines,
                sampling: &request.sampling,
                schema: request.schema,
                tools: request.tools,
                context_tokens: request_size(request).context_tokens(self.pictures.longer_px()),
            };
            let wire = self.endpoint.provider.dialect.to_wire(dialect_request);
            let wire = wire.map_err(|reason| CallError::Failed(reason.to_owned()))?;
            let kind =
                CallKind { model: self.name.clone(), has_pictures: lines.iter().any(|line| !line.pictures.is_empty()) };
            let prepared = PreparedCall {
                endpoint: &self.endpoint,
                run: &self.run,
                key: key.as_str(),
                kind: &kind,
                wire: &wire,
                price: self.price.as_ref(),
                size: request_size(request),
                attempts: self.attempts,
            };
            prepared.make_call(attempts).inspect_err(|error| attempts.set_failure_kind(error.kind_name()))
        });
        answer.map(reply_from_answer).map_err(|error| self.model_error(error))
    }

    /// The part of the model's name after the provider's.
    pub(crate) fn model_name(&self) -> &str {
        self.name.split_once('/').map_or("", |(_, model)| model)
    }

    /// Messages that are ready to be sent, with their pictures encoded.
    fn encode_messages(&self, messages: &[ChatMessage]) -> Result<Vec<RemoteMessage>, String> {
        let line = |message: &ChatMessage| {
            let pictures = message.images.iter().map(|image| self.pictures.encode(image)).collect::<Result<_, _>>()?;
            Ok(RemoteMessage { role: message.role, text: message.text.clone(), pictures })
        };
        messages.iter().map(line).collect()
    }

    /// The call for the ledger: everything that could change its answer, with hashes in place of pictures.
    fn ledger_call(&self, request: &ModelRequest, lines: &[RemoteMessage]) -> ModelCall {
        let provider = &self.endpoint.provider;
        let message = |line: &RemoteMessage| {
            let mut message = Map::new();
            message.insert("role".to_owned(), json!(line.role));
            message.insert("text".to_owned(), line.text.clone().into());
            match &line.pictures[..] {
                [] => {}
                [only] => drop(message.insert("image_sha256".to_owned(), only.sha256.clone().into())),
                several => {
                    let hashes = several.iter().map(|picture| Value::from(picture.sha256.as_str()));
                    message.insert("images_sha256".to_owned(), hashes.collect());
                }
            }
            if !line.pictures.is_empty() {
                message.insert("picture_px".to_owned(), self.pictures.longer_px().into());
            }
            Value::Object(message)
        };
        let sampling = &request.sampling;
        let mut fields = Map::new();
        fields.insert("dialect".to_owned(), provider.dialect.name().into());
        fields.insert("messages".to_owned(), lines.iter().map(message).collect());
        fields.insert("temperature".to_owned(), sampling.temperature.into());
        fields.insert("max_tokens".to_owned(), sampling.max_tokens.into());
        fields.insert("seed".to_owned(), sampling.seed.into());
        if let Some(schema) = request.schema.filter(|_| provider.json != JsonMode::Prompt) {
            fields.insert(
                "schema".to_owned(),
                json!({ "name": schema.name, "way": format!("{:?}", provider.json), "json": schema.json }),
            );
        }
        if provider.tools && !request.tools.is_empty() {
            let tool = |tool: &ModelTool| json!({ "name": tool.name, "does": tool.does, "arguments": tool.arguments });
            fields.insert("tools".to_owned(), request.tools.iter().map(tool).collect());
        }
        if !provider.extra.is_empty() {
            fields.insert("extra".to_owned(), provider.extra.clone().into());
        }
        if !provider.omit.is_empty() {
            fields.insert("omit".to_owned(), provider.omit.clone().into());
        }
        ModelCall {
            model: self.name.clone(),
            base_url: provider.base_url.as_str().to_owned(),
            request: fields.into(),
            replicate: request.replicate,
        }
    }

    fn failed_error(&self, reason: impl Into<String>) -> ModelError {
        ModelError::Failed { model: self.name.clone(), reason: reason.into() }
    }

    fn model_error(&self, error: OnceError<CallError>) -> ModelError {
        match error {
            OnceError::Call(CallError::Failed(reason)) => self.failed_error(reason),
            OnceError::Call(CallError::Lost(reason)) => ModelError::Lost { model: self.name.clone(), reason },
            OnceError::Call(CallError::Closed(ClosedEndpoint { reason, hint })) => {
                ModelError::Stopped { reason, hint, is_lost: false }
            }
            OnceError::Call(CallError::Refused(refused)) | OnceError::Refused(refused) => stopped_error(&refused),
            OnceError::Ledger(error) => stopped_error(&RequestRefusedError::Ledger(error)),
            // A replay of a recorded run has no answer only where the item also failed in the recorded run.
            missing @ OnceError::NotRecorded { .. } => {
                self.failed_error(missing.to_string().lines().next().unwrap_or("not recorded"))
            }
        }
    }
}

/// The error after which the ledger allows no more requests.
fn stopped_error(refused: &RequestRefusedError) -> ModelError {
    let (reason, hint) = refused.reason_and_hint();
    ModelError::Stopped { reason, hint, is_lost: refused.is_lost() }
}

/// The size of a request. 16 characters are added for each message and tool, for the JSON around it.
fn request_size(request: &ModelRequest) -> RequestSize {
    let tool_chars = |tool: &ModelTool| (tool.name.len() + tool.does.len() + tool.arguments.len()) as u64 + 16;
    let message_chars = request.messages.iter().map(|message| message.text.chars().count() as u64 + 16);
    let chars = message_chars.chain(request.tools.iter().map(tool_chars)).sum();
    let other_bytes = |message: &ChatMessage| message.text.bytes().filter(|byte| !byte.is_ascii()).count() as u64;
    let other_bytes = request.messages.iter().map(other_bytes).sum();
    let pictures = request.messages.iter().map(|message| message.images.len() as u64).sum();
    RequestSize { chars, other_bytes, pictures, max_tokens: request.sampling.max_tokens.into() }
}

fn reply_from_answer(answer: CallAnswer) -> ModelReply {
    let finish = if answer.finish == "length" { FinishReason::Length } else { FinishReason::Stop };
    let CallAnswer { text, tokens_in, tokens_out, usd, latency_ms, .. } = answer;
    let usage = ModelUsage { tokens_in, tokens_out, usd, seconds: latency_ms as f64 / 1e3 };
    ModelReply { text, finish, usage: Some(usage) }
}

impl LanguageModel for RemoteModel {
    fn name(&self) -> &str {
        &self.name
    }

    fn context_tokens(&self) -> Option<u64> {
        self.endpoint.provider.context_tokens
    }

    fn note(&self, note: String) {
        self.endpoint.note(note);
    }

    fn complete_requests(&self, requests: &[ModelRequest]) -> Vec<Result<ModelReply, ModelError>> {
        if let [only] = requests {
            return vec![self.complete_one(only)];
        }
        let context = CallContext::from_current_thread();
        let next = AtomicUsize::new(0);
        let work = || {
            let mut done = Vec::new();
            while let Some((at, request)) = take_next(&next, requests) {
                done.push((at, self.complete_one(request)));
            }
            done
        };
        let mut results: Vec<Option<Result<ModelReply, ModelError>>> = requests.iter().map(|_| None).collect();
        thread::scope(|scope| {
            let threads: Vec<_> =
                (0..self.threads.min(requests.len())).map(|_| scope.spawn(|| context.run_within(work))).collect();
            for (at, result) in threads.into_iter().filter_map(|thread| thread.join().ok()).flatten() {
                results[at] = Some(result);
            }
        });
        results
            .into_iter()
            .map(|result| result.unwrap_or_else(|| Err(self.failed_error("lost by a thread that ended early"))))
            .collect()
    }
}

/// The next request that no thread works on yet, with its index.
fn take_next<'a>(next: &AtomicUsize, requests: &'a [ModelRequest]) -> Option<(usize, &'a ModelRequest)> {
    let at = next.fetch_add(1, Ordering::Relaxed);
    requests.get(at).map(|request| (at, request))
}

impl fmt::Debug for RemoteModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let base_url = &self.endpoint.provider.base_url;
        f.debug_struct("RemoteModel").field("name", &self.name).field("base_url", base_url).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::SamplingOptions;

    /// If a tokenizer does not know a script, each byte is a token.
    #[test]
    fn max_tokens_in_bounds_every_script() {
        let sampling = SamplingOptions { temperature: 0.0, max_tokens: 20, seed: 0 };
        for text in ["మెట్లు ఎక్కండి", "सीढ़ियाँ चढ़ो", "\u{1f6cb}\u{1f6aa}"]
        {
            let text = text.repeat(100);
            let (bytes, messages) = (text.len() as u64, vec![ChatMessage::from_user(text)]);
            let size = request_size(&ModelRequest {
                messages,
                sampling: sampling.clone(),
                replicate: 0,
                schema: None,
                tools: &[],
            });
            assert!(size.max_tokens_in(0) >= bytes, "{size:?}");
        }
    }
}

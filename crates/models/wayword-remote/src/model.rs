//! A model behind HTTP: turns requests into calls of the ledger, makes those that the ledger has no answer for, and
//! answers batches with several threads.

use crate::{
    Json, Price,
    call::{Sending, Size, Unanswered},
    dialect::{Asked, Line},
    endpoint::{Closed, Endpoint},
    picture::Pictures,
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
use wayword_core::{Finish, LanguageModel, Message, ModelError, Reply, Request, Tool, Usage};
use wayword_ledger::{Answer, Call, Occasion, OnceError, Refused, Run};

/// A model behind HTTP. Each of its calls is made once and kept in the ledger.
pub struct RemoteModel {
    /// `provider/model`.
    pub(crate) name: String,
    pub(crate) endpoint: Arc<Endpoint>,
    pub(crate) run: Run,
    pub(crate) pictures: Arc<Pictures>,
    pub(crate) price: Option<Price>,
    /// Most attempts per call.
    pub(crate) attempts: u32,
    /// Most threads that work on one batch.
    pub(crate) threads: usize,
}

impl RemoteModel {
    /// Its price, if it is known.
    #[must_use]
    pub fn price(&self) -> Option<&Price> {
        self.price.as_ref()
    }

    fn one(&self, request: &Request) -> Result<Reply, ModelError> {
        let lines = self.lines(&request.messages).map_err(|reason| self.failed(reason))?;
        let call = self.call(request, &lines);
        let key = call.key();
        let asked = self.run.once(&call, |attempts| {
            let asked = Asked {
                provider: &self.endpoint.provider,
                model: self.model(),
                lines: &lines,
                sampling: &request.sampling,
                schema: request.schema,
                tools: request.tools,
            };
            let wire = self.endpoint.provider.dialect.to_wire(asked);
            let wire = wire.map_err(|reason| Unanswered::Failed(reason.to_owned()))?;
            let sending = Sending {
                endpoint: &self.endpoint,
                run: &self.run,
                key: key.as_str(),
                wire: &wire,
                price: self.price.as_ref(),
                size: size(request),
                attempts: self.attempts,
            };
            sending.make(attempts).inspect_err(|error| attempts.fails_as(error.kind()))
        });
        asked.map(reply).map_err(|error| self.error(error))
    }

    /// The part of its name after the provider's.
    pub(crate) fn model(&self) -> &str {
        self.name.split_once('/').map_or("", |(_, model)| model)
    }

    fn lines(&self, messages: &[Message]) -> Result<Vec<Line>, String> {
        let line = |message: &Message| {
            let pictures = message.images.iter().map(|image| self.pictures.encode(image)).collect::<Result<_, _>>()?;
            Ok(Line { role: message.role, text: message.text.clone(), pictures })
        };
        messages.iter().map(line).collect()
    }

    /// The call for the ledger: everything that could change its answer, with hashes in place of pictures.
    fn call(&self, request: &Request, lines: &[Line]) -> Call {
        let provider = &self.endpoint.provider;
        let message = |line: &Line| {
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
        let mut asked = Map::new();
        asked.insert("dialect".to_owned(), provider.dialect.name().into());
        asked.insert("messages".to_owned(), lines.iter().map(message).collect());
        asked.insert("temperature".to_owned(), sampling.temperature.into());
        asked.insert("max_tokens".to_owned(), sampling.max_tokens.into());
        asked.insert("seed".to_owned(), sampling.seed.into());
        if let Some(schema) = request.schema.filter(|_| provider.json != Json::Prompt) {
            asked.insert(
                "schema".to_owned(),
                json!({ "name": schema.name, "way": format!("{:?}", provider.json), "json": schema.json }),
            );
        }
        if provider.tools && !request.tools.is_empty() {
            let tool = |tool: &Tool| json!({ "name": tool.name, "does": tool.does, "arguments": tool.arguments });
            asked.insert("tools".to_owned(), request.tools.iter().map(tool).collect());
        }
        if !provider.extra.is_empty() {
            asked.insert("extra".to_owned(), provider.extra.clone().into());
        }
        if !provider.omit.is_empty() {
            asked.insert("omit".to_owned(), provider.omit.clone().into());
        }
        Call {
            model: self.name.clone(),
            base_url: provider.base_url.as_str().to_owned(),
            request: asked.into(),
            replicate: request.replicate,
        }
    }

    fn failed(&self, reason: impl Into<String>) -> ModelError {
        ModelError::Failed { model: self.name.clone(), reason: reason.into() }
    }

    fn error(&self, error: OnceError<Unanswered>) -> ModelError {
        match error {
            OnceError::Call(Unanswered::Failed(reason)) => self.failed(reason),
            OnceError::Call(Unanswered::Lost(reason)) => ModelError::Lost { model: self.name.clone(), reason },
            OnceError::Call(Unanswered::Closed(Closed { reason, hint })) => {
                ModelError::Stopped { reason, hint, is_lost: false }
            }
            OnceError::Call(Unanswered::Refused(refused)) | OnceError::Refused(refused) => stopped(&refused),
            OnceError::Ledger(error) => stopped(&Refused::Ledger(error)),
            // The item also failed when the recording was made.
            missing @ OnceError::NotRecorded { .. } => {
                self.failed(missing.to_string().lines().next().unwrap_or("not recorded"))
            }
        }
    }
}

/// The error after which the ledger allows no more requests.
fn stopped(refused: &Refused) -> ModelError {
    let (reason, hint) = refused.told();
    ModelError::Stopped { reason, hint, is_lost: refused.is_lost() }
}

fn size(request: &Request) -> Size {
    let of_tools = |tool: &Tool| (tool.name.len() + tool.does.len() + tool.arguments.len()) as u64 + 16;
    let of_messages = request.messages.iter().map(|message| message.text.chars().count() as u64 + 16);
    let chars = of_messages.chain(request.tools.iter().map(of_tools)).sum();
    let other_bytes = |message: &Message| message.text.bytes().filter(|byte| !byte.is_ascii()).count() as u64;
    let other_bytes = request.messages.iter().map(other_bytes).sum();
    let pictures = request.messages.iter().map(|message| message.images.len() as u64).sum();
    Size { chars, other_bytes, pictures, max_tokens: request.sampling.max_tokens.into() }
}

fn reply(answer: Answer) -> Reply {
    let finish = if answer.finish == "length" { Finish::Length } else { Finish::Stop };
    let Answer { text, tokens_in, tokens_out, usd, latency_ms, .. } = answer;
    let usage = Usage { tokens_in, tokens_out, usd, seconds: latency_ms as f64 / 1e3 };
    Reply { text, finish, usage: Some(usage) }
}

impl LanguageModel for RemoteModel {
    fn name(&self) -> &str {
        &self.name
    }

    fn complete(&self, requests: &[Request]) -> Vec<Result<Reply, ModelError>> {
        if let [only] = requests {
            return vec![self.one(only)];
        }
        let occasion = Occasion::here();
        let next = AtomicUsize::new(0);
        let work = || {
            let mut done = Vec::new();
            while let Some((at, request)) = take(&next, requests) {
                done.push((at, self.one(request)));
            }
            done
        };
        let mut results: Vec<Option<Result<Reply, ModelError>>> = requests.iter().map(|_| None).collect();
        thread::scope(|scope| {
            let threads: Vec<_> =
                (0..self.threads.min(requests.len())).map(|_| scope.spawn(|| occasion.on(work))).collect();
            for (at, result) in threads.into_iter().filter_map(|thread| thread.join().ok()).flatten() {
                results[at] = Some(result);
            }
        });
        results
            .into_iter()
            .map(|result| result.unwrap_or_else(|| Err(self.failed("lost by a thread that ended early"))))
            .collect()
    }
}

fn take<'a>(next: &AtomicUsize, requests: &'a [Request]) -> Option<(usize, &'a Request)> {
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
    use wayword_core::Sampling;

    /// If a tokenizer does not know a script, each byte is a token.
    #[test]
    fn most_tokens_in_bounds_every_script() {
        let sampling = Sampling { temperature: 0.0, max_tokens: 20, seed: 0 };
        for text in ["మెట్లు ఎక్కండి", "सीढ़ियाँ चढ़ो", "\u{1f6cb}\u{1f6aa}"]
        {
            let text = text.repeat(100);
            let (bytes, messages) = (text.len() as u64, vec![Message::user(text)]);
            let size = size(&Request { messages, sampling: sampling.clone(), replicate: 0, schema: None, tools: &[] });
            assert!(size.most_tokens_in(0) >= bytes, "{size:?}");
        }
    }
}

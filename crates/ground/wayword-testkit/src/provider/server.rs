//! The HTTP server: routes requests by dialect, checks key and rate, waits the latency, asks the script, and answers or commits
//! the fault that was drawn.

use super::{
    Behaviour, Dialect, Heard, Log,
    dialect::{End, Said, Wrong, with_calls},
    misdeed::{self, Misdeed, key_of},
    rate::Bucket,
    wire::{Door, Line},
};
use axum::{
    Router,
    body::Bytes,
    extract::{ConnectInfo, DefaultBodyLimit, Path, State},
    http::HeaderMap,
    response::Response,
    routing::{MethodRouter, get, post},
};
use serde_json::{Value, json};
use std::{
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Instant,
};
use tokio::net::TcpListener;

/// Largest request that is accepted; several pictures fit.
const LARGEST_BODY: usize = 64 << 20;
/// Tokens that are billed for a picture: about as many as two large services bill for 512 x 384 pixels.
const PICTURE_TOKENS: u64 = 262;
/// Characters of English text for each of its tokens.
const CHARS_PER_TOKEN: u64 = 4;

/// The state that all connections share.
pub(super) struct Shared {
    behaviour: Behaviour,
    bucket: Option<Mutex<Bucket>>,
    log: Mutex<Log>,
}

/// A request as it came.
struct Arrival {
    dialect: Dialect,
    /// The model, where the address names it.
    model: Option<String>,
    headers: HeaderMap,
    body: Bytes,
    line: Line,
}

pub(super) async fn serve(listener: TcpListener, shared: Arc<Shared>) {
    let router = Router::new()
        .route("/v1/chat/completions", asked(Dialect::OpenAi))
        .route("/v1/completions", asked(Dialect::Completions))
        .route("/v1/messages", asked(Dialect::Anthropic))
        .route("/api/chat", asked(Dialect::Ollama))
        .route("/api/show", post(show))
        .route("/v1beta/models/{action}", asked_of_gemini())
        .route("/v1/models", list(Dialect::OpenAi))
        .route("/v1beta/models", list(Dialect::Gemini))
        .route("/api/tags", list(Dialect::Ollama))
        .layer(DefaultBodyLimit::max(LARGEST_BODY))
        .with_state(shared);
    // It ends only with the runtime.
    let _ = axum::serve(Door(listener), router.into_make_service_with_connect_info::<Line>()).await;
}

fn asked(dialect: Dialect) -> MethodRouter<Arc<Shared>> {
    post(
        move |State(shared): State<Arc<Shared>>,
              ConnectInfo(line): ConnectInfo<Line>,
              headers: HeaderMap,
              body: Bytes| { shared.worked(Arrival { dialect, model: None, headers, body, line }) },
    )
}

fn asked_of_gemini() -> MethodRouter<Arc<Shared>> {
    post(
        move |State(shared): State<Arc<Shared>>,
              ConnectInfo(line): ConnectInfo<Line>,
              Path(action): Path<String>,
              headers: HeaderMap,
              body: Bytes| {
            let model = Some(action.strip_suffix(":generateContent").unwrap_or_default().to_owned());
            shared.worked(Arrival { dialect: Dialect::Gemini, model, headers, body, line })
        },
    )
}

/// Ollama's `/api/show`: lists the capabilities of a model.
async fn show(State(shared): State<Arc<Shared>>, body: Bytes) -> Response {
    let asked: Value = serde_json::from_slice(&body).unwrap_or_default();
    let model = asked["model"].as_str().unwrap_or_default();
    if !shared.behaviour.scripts.contains_key(model) {
        return Dialect::Ollama.refuse(Wrong::Model, "There is no such model.");
    }
    let capabilities =
        if shared.behaviour.blind.contains(model) { vec!["completion"] } else { vec!["completion", "vision"] };
    misdeed::json(&json!({ "capabilities": capabilities }))
}

fn list(dialect: Dialect) -> MethodRouter<Arc<Shared>> {
    get(move |State(shared): State<Arc<Shared>>, headers: HeaderMap| async move {
        // OpenAI's and Anthropic's lists have one address.
        let dialect = if headers.contains_key("x-api-key") { Dialect::Anthropic } else { dialect };
        if !shared.opens(dialect, &headers) {
            return dialect.refuse(Wrong::Key, "The API key is not valid.");
        }
        let names: Vec<&str> = shared.behaviour.scripts.keys().map(String::as_str).collect();
        misdeed::json(&dialect.models(&names))
    })
}

impl Shared {
    pub(super) fn new(behaviour: Behaviour) -> Self {
        let bucket = behaviour.rate.map(|rate| Mutex::new(Bucket::full(rate, Instant::now())));
        Self { behaviour, bucket, log: Mutex::default() }
    }

    pub(super) fn tally(&self) -> MutexGuard<'_, Log> {
        self.log.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Handles a request to its end, even if the client hangs up meanwhile, because a real service bills it all the same.
    async fn worked(self: Arc<Self>, arrival: Arrival) -> Response {
        let dialect = arrival.dialect;
        let work = tokio::spawn(async move {
            let request = arrival.hash();
            let round = self.tally().receive(request);
            let response = self.answered(&arrival, request).await;
            self.tally().finish(round);
            response
        });
        work.await.unwrap_or_else(|_| dialect.refuse(Wrong::Server, "The script panicked."))
    }

    async fn answered(&self, arrival: &Arrival, request: u64) -> Response {
        let (index, nth) = match self.admitted(arrival, request) {
            Ok(before) => before,
            Err(refusal) => return *refusal,
        };
        tokio::time::sleep(self.behaviour.latency).await;
        let said = match self.said(arrival) {
            Ok(said) => said,
            Err(refusal) => return *refusal,
        };
        match self.behaviour.faults.of(self.behaviour.seed, index, request, nth) {
            None => {
                self.tally().answer(request);
                misdeed::json(&arrival.dialect.answer(&said))
            }
            Some(fault) => {
                *self.tally().faults.entry(fault).or_default() += 1;
                let Arrival { dialect, headers, line, .. } = arrival;
                Misdeed { dialect: *dialect, faults: &self.behaviour.faults, line, headers, said }.commit(fault)
            }
        }
    }

    fn opens(&self, dialect: Dialect, headers: &HeaderMap) -> bool {
        self.behaviour.key.as_ref().is_none_or(|key| *key == key_of(dialect, headers))
    }

    /// Lets a request in and returns how many were let in before it, and how many of them were equal to it; `Err` with the
    /// refusal if its key, the rate or the quota forbids it.
    fn admitted(&self, arrival: &Arrival, request: u64) -> Result<(u64, u64), Box<Response>> {
        let dialect = arrival.dialect;
        let mut log = self.tally();
        if !self.opens(dialect, &arrival.headers) {
            log.key_refused += 1;
            return Err(Box::new(dialect.refuse(Wrong::Key, "The API key is not valid.")));
        }
        let bucket = self.bucket.as_ref().map(|bucket| bucket.lock().unwrap_or_else(PoisonError::into_inner));
        if let Some(Err((form, wait))) = bucket.map(|mut bucket| bucket.take(Instant::now())) {
            log.rate_limited += 1;
            return Err(Box::new(dialect.too_many(form, wait)));
        }
        let faults = &self.behaviour.faults;
        let is_over = |limit: Option<u64>| limit.is_some_and(|limit| log.admitted >= limit);
        if is_over(faults.key_refused_after) {
            log.key_refused += 1;
            return Err(Box::new(dialect.refuse(Wrong::Key, "The API key was revoked.")));
        }
        if is_over(faults.quota_after) {
            log.out_of_quota += 1;
            return Err(Box::new(dialect.refuse(Wrong::Quota, dialect.quota_message())));
        }
        Ok(log.admit(request))
    }

    /// The model's reply to a request.
    fn said(&self, arrival: &Arrival) -> Result<Said, Box<Response>> {
        let dialect = arrival.dialect;
        let refused = |wrong: Wrong, message: &str| {
            self.tally().unfit += 1;
            Box::new(dialect.refuse(wrong, message))
        };
        let body: serde_json::Value =
            serde_json::from_slice(&arrival.body).map_err(|_| refused(Wrong::Request, "This is not JSON."))?;
        let heard = dialect.heard(&body, arrival.model.as_deref()).map_err(|why| refused(Wrong::Request, why))?;
        let script = self.behaviour.scripts.get(&heard.model);
        let script = script.ok_or_else(|| refused(Wrong::Model, "There is no such model."))?;
        let tokens_in = heard.messages.iter().map(|(_, text)| tokens(text)).sum::<u64>();
        let tokens_in = tokens_in + PICTURE_TOKENS * heard.pictures.len() as u64;
        let (text, end) = cut(script.reply(&heard), &heard);
        let tokens_out = tokens(&text);
        let (text, calls) = with_calls(text, &body);
        Ok(Said { tokens_in, tokens_out, text, calls, end, model: heard.model })
    }
}

impl Arrival {
    fn hash(&self) -> u64 {
        let model = self.model.as_deref().unwrap_or_default();
        let body = String::from_utf8_lossy(&self.body);
        wayword_core::seed::derive(0, &[self.dialect.name(), model, &body])
    }
}

fn tokens(text: &str) -> u64 {
    (text.len() as u64).div_ceil(CHARS_PER_TOKEN)
}

fn words(text: &str) -> u64 {
    text.split_whitespace().count() as u64
}

/// The reply, cut to the number of words that the request allows.
fn cut(reply: String, heard: &Heard) -> (String, End) {
    let most = heard.max_tokens.and_then(|most| usize::try_from(most).ok()).unwrap_or(usize::MAX);
    if words(&reply) <= most as u64 {
        return (reply, End::Stop);
    }
    let kept: Vec<&str> = reply.split_whitespace().take(most).collect();
    (kept.join(" "), End::Length)
}

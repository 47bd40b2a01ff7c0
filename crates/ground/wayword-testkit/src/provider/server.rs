//! The HTTP server: routes requests by dialect, checks key and rate, waits the latency, asks the script, and answers or commits
//! the fault that was drawn.

use super::{
    ProviderBehaviour, ProviderDialect, ProviderLog, ScriptRequest,
    breakable_connection::{BreakSwitch, BreakableListener},
    dialect::{ReplyEnding, ScriptReply, ServiceErrorKind, split_tool_calls},
    fault_response::{self, FaultResponder, request_key},
    request_rate::ProviderTokenBucket,
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

/// Largest body of a request that is accepted, bytes; several pictures fit. A larger one is refused with 413.
const MAX_BODY_BYTES: usize = 64 << 20;
/// Tokens that are billed for a picture: about as many as two large services bill for 512 x 384 pixels.
const PICTURE_TOKENS: u64 = 262;
/// Characters of English text for each of its tokens.
const CHARS_PER_TOKEN: u64 = 4;

/// The state that all connections share.
pub(super) struct ProviderState {
    behaviour: ProviderBehaviour,
    /// The rate limit; `None` for no limit.
    bucket: Option<Mutex<ProviderTokenBucket>>,
    log: Mutex<ProviderLog>,
}

/// A request as it came.
struct IncomingRequest {
    dialect: ProviderDialect,
    /// The model, where the address names it.
    model: Option<String>,
    headers: HeaderMap,
    body: Bytes,
    /// Orders the connection of the request to break.
    line: BreakSwitch,
}

/// Serves all dialects on one port until the runtime ends.
pub(super) async fn serve_connections(listener: TcpListener, shared: Arc<ProviderState>) {
    let router = Router::new()
        .route("/v1/chat/completions", ask_route(ProviderDialect::OpenAi))
        .route("/v1/completions", ask_route(ProviderDialect::Completions))
        .route("/v1/messages", ask_route(ProviderDialect::Anthropic))
        .route("/api/chat", ask_route(ProviderDialect::Ollama))
        .route("/api/show", post(show_model))
        .route("/v1beta/models/{action}", gemini_ask_route())
        .route("/v1/models", list_route(ProviderDialect::OpenAi))
        .route("/v1beta/models", list_route(ProviderDialect::Gemini))
        .route("/api/tags", list_route(ProviderDialect::Ollama))
        .layer(DefaultBodyLimit::max(MAX_BODY_BYTES))
        .with_state(shared);
    // It ends only with the runtime.
    let _ = axum::serve(BreakableListener(listener), router.into_make_service_with_connect_info::<BreakSwitch>()).await;
}

/// The route of a dialect for requests to a model.
fn ask_route(dialect: ProviderDialect) -> MethodRouter<Arc<ProviderState>> {
    post(
        move |State(shared): State<Arc<ProviderState>>,
              ConnectInfo(line): ConnectInfo<BreakSwitch>,
              headers: HeaderMap,
              body: Bytes| {
            shared.handle_arrival(IncomingRequest { dialect, model: None, headers, body, line })
        },
    )
}

/// Gemini's route for requests to a model: the address contains the model's name.
fn gemini_ask_route() -> MethodRouter<Arc<ProviderState>> {
    post(
        move |State(shared): State<Arc<ProviderState>>,
              ConnectInfo(line): ConnectInfo<BreakSwitch>,
              Path(action): Path<String>,
              headers: HeaderMap,
              body: Bytes| {
            let model = Some(action.strip_suffix(":generateContent").unwrap_or_default().to_owned());
            shared.handle_arrival(IncomingRequest { dialect: ProviderDialect::Gemini, model, headers, body, line })
        },
    )
}

/// Ollama's `/api/show`: lists the capabilities of a model.
async fn show_model(State(shared): State<Arc<ProviderState>>, body: Bytes) -> Response {
    let request: Value = serde_json::from_slice(&body).unwrap_or_default();
    let model = request["model"].as_str().unwrap_or_default();
    if !shared.behaviour.scripts.contains_key(model) {
        return ProviderDialect::Ollama.error_response(ServiceErrorKind::Model, "There is no such model.");
    }
    let capabilities =
        if shared.behaviour.blind.contains(model) { vec!["completion"] } else { vec!["completion", "vision"] };
    fault_response::json_response(&json!({ "capabilities": capabilities }))
}

/// The route of a dialect for the list of models.
fn list_route(dialect: ProviderDialect) -> MethodRouter<Arc<ProviderState>> {
    get(move |State(shared): State<Arc<ProviderState>>, headers: HeaderMap| async move {
        // OpenAI's and Anthropic's lists have one address.
        let dialect = if headers.contains_key("x-api-key") { ProviderDialect::Anthropic } else { dialect };
        if !shared.accepts_key(dialect, &headers) {
            return dialect.error_response(ServiceErrorKind::Key, "The API key is not valid.");
        }
        let names: Vec<&str> = shared.behaviour.scripts.keys().map(String::as_str).collect();
        fault_response::json_response(&dialect.model_list(&names))
    })
}

impl ProviderState {
    pub(super) fn new(behaviour: ProviderBehaviour) -> Self {
        let bucket = behaviour.rate.map(|rate| Mutex::new(ProviderTokenBucket::full(rate, Instant::now())));
        Self { behaviour, bucket, log: Mutex::default() }
    }

    pub(super) fn lock_log(&self) -> MutexGuard<'_, ProviderLog> {
        self.log.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Handles a request to its end, even if the client hangs up meanwhile, because a real service bills it all the same.
    async fn handle_arrival(self: Arc<Self>, arrival: IncomingRequest) -> Response {
        let dialect = arrival.dialect;
        let work = tokio::spawn(async move {
            let request = arrival.request_hash();
            let round = self.lock_log().count_arrival(request);
            let response = self.answer_arrival(&arrival, request).await;
            self.lock_log().finish_round(round);
            response
        });
        work.await.unwrap_or_else(|_| dialect.error_response(ServiceErrorKind::Server, "The script panicked."))
    }

    /// The response to a request: a refusal, a whole answer or a fault. `request` is its hash.
    async fn answer_arrival(&self, arrival: &IncomingRequest, request: u64) -> Response {
        let (index, nth) = match self.admit_arrival(arrival, request) {
            Ok(before) => before,
            Err(refusal) => return *refusal,
        };
        tokio::time::sleep(self.behaviour.latency).await;
        let said = match self.ask_script(arrival) {
            Ok(said) => said,
            Err(refusal) => return *refusal,
        };
        match self.behaviour.faults.for_request(self.behaviour.seed, index, request, nth) {
            None => {
                self.lock_log().count_answer(request);
                fault_response::json_response(&arrival.dialect.reply_body(&said))
            }
            Some(fault) => {
                *self.lock_log().faults.entry(fault).or_default() += 1;
                let IncomingRequest { dialect, headers, line, .. } = arrival;
                FaultResponder { dialect: *dialect, faults: &self.behaviour.faults, line, headers, good_reply: said }
                    .respond_with_fault(fault)
            }
        }
    }

    /// Whether the key of a request is the right one, or none is needed.
    fn accepts_key(&self, dialect: ProviderDialect, headers: &HeaderMap) -> bool {
        self.behaviour.key.as_ref().is_none_or(|key| *key == request_key(dialect, headers))
    }

    /// Lets a request in and returns how many were let in before it, and how many of them were equal to it; `Err` with the
    /// refusal if its key, the rate or the quota forbids it.
    fn admit_arrival(&self, arrival: &IncomingRequest, request: u64) -> Result<(u64, u64), Box<Response>> {
        let dialect = arrival.dialect;
        let mut log = self.lock_log();
        if !self.accepts_key(dialect, &arrival.headers) {
            log.key_refused += 1;
            return Err(Box::new(dialect.error_response(ServiceErrorKind::Key, "The API key is not valid.")));
        }
        let bucket = self.bucket.as_ref().map(|bucket| bucket.lock().unwrap_or_else(PoisonError::into_inner));
        if let Some(Err((form, wait))) = bucket.map(|mut bucket| bucket.take_request(Instant::now())) {
            log.rate_limited += 1;
            return Err(Box::new(dialect.too_many(form, wait)));
        }
        let faults = &self.behaviour.faults;
        let is_over = |limit: Option<u64>| limit.is_some_and(|limit| log.admitted >= limit);
        if is_over(faults.key_refused_after) {
            log.key_refused += 1;
            return Err(Box::new(dialect.error_response(ServiceErrorKind::Key, "The API key was revoked.")));
        }
        if is_over(faults.quota_after) {
            log.out_of_quota += 1;
            return Err(Box::new(dialect.error_response(ServiceErrorKind::Quota, dialect.quota_message())));
        }
        Ok(log.count_admission(request))
    }

    /// The reply of the model's script to a request; `Err` with the error if the request is malformed or the model unknown.
    fn ask_script(&self, arrival: &IncomingRequest) -> Result<ScriptReply, Box<Response>> {
        let dialect = arrival.dialect;
        let refused = |kind: ServiceErrorKind, message: &str| {
            self.lock_log().unfit += 1;
            Box::new(dialect.error_response(kind, message))
        };
        let body: serde_json::Value = serde_json::from_slice(&arrival.body)
            .map_err(|_| refused(ServiceErrorKind::Request, "This is not JSON."))?;
        let request = dialect
            .read_request(&body, arrival.model.as_deref())
            .map_err(|why| refused(ServiceErrorKind::Request, why))?;
        let script = self.behaviour.scripts.get(&request.model);
        let script = script.ok_or_else(|| refused(ServiceErrorKind::Model, "There is no such model."))?;
        let tokens_in = request.messages.iter().map(|(_, text)| count_tokens(text)).sum::<u64>();
        let tokens_in = tokens_in + PICTURE_TOKENS * request.pictures.len() as u64;
        let (text, end) = cut_reply(script.reply(&request), &request);
        let tokens_out = count_tokens(&text);
        let (text, calls) = split_tool_calls(text, &body);
        Ok(ScriptReply { tokens_in, tokens_out, text, calls, end, model: request.model })
    }
}

impl IncomingRequest {
    /// A hash of the request's dialect, model and body. Equal requests have equal hashes.
    fn request_hash(&self) -> u64 {
        let model = self.model.as_deref().unwrap_or_default();
        let body = String::from_utf8_lossy(&self.body);
        wayword_core::seed::derive_seed(0, &[self.dialect.name(), model, &body])
    }
}

/// About how many tokens a text has.
fn count_tokens(text: &str) -> u64 {
    (text.len() as u64).div_ceil(CHARS_PER_TOKEN)
}

fn count_words(text: &str) -> u64 {
    text.split_whitespace().count() as u64
}

/// The reply, cut to the number of words that the request allows.
fn cut_reply(reply: String, request: &ScriptRequest) -> (String, ReplyEnding) {
    let max_words = request.max_tokens.and_then(|max| usize::try_from(max).ok()).unwrap_or(usize::MAX);
    if count_words(&reply) <= max_words as u64 {
        return (reply, ReplyEnding::Stop);
    }
    let kept: Vec<&str> = reply.split_whitespace().take(max_words).collect();
    (kept.join(" "), ReplyEnding::Length)
}

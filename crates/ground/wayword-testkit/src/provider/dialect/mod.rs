//! The dialects of providers, one file each: how to read a request, and how to write replies, errors and lists of models.

mod anthropic;
mod completions;
mod gemini;
mod ollama;
mod openai;
mod request_parts;

use super::{RetryAfter, ScriptRequest, retry_after::end_of_wait};
use axum::{
    http::{HeaderName, HeaderValue, StatusCode, header},
    response::{IntoResponse, Response},
};
use serde_json::Value;
use std::time::Duration;

/// The API of a provider.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProviderDialect {
    /// OpenAI's chat completions.
    OpenAi,
    /// OpenAI's legacy completions.
    Completions,
    /// Anthropic's messages.
    Anthropic,
    /// Gemini's `generateContent`.
    Gemini,
    /// Ollama's own chat.
    Ollama,
}

/// A script's reply before it is written in a dialect.
#[derive(Debug, Clone)]
pub(super) struct ScriptReply {
    /// The name of the model.
    pub(super) model: String,
    /// The words of the reply.
    pub(super) text: String,
    /// Calls of tools: name and arguments. They are not in the text.
    pub(super) calls: Vec<(String, Value)>,
    /// Why the reply ends.
    pub(super) end: ReplyEnding,
    /// Tokens of the request that are billed: one for four bytes of text, and a fixed number for each picture.
    pub(super) tokens_in: u64,
    /// Tokens of the reply that are billed.
    pub(super) tokens_out: u64,
}

/// Why a reply ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ReplyEnding {
    /// It is complete.
    Stop,
    /// It reached the limit of tokens and was cut off.
    Length,
    /// The service's filter withholds it.
    Filtered,
    /// The model refuses to answer.
    Refused,
}

/// The kinds of errors that a service reports, about a request or about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ServiceErrorKind {
    /// The request is malformed.
    Request,
    /// The key is missing or wrong.
    Key,
    /// There is no such model.
    Model,
    /// The account is empty.
    Quota,
    /// Too many requests came for the rate.
    TooMany,
    /// The service has an internal error.
    Server,
    /// The service is not ready.
    Unavailable,
    /// The service has too much to do.
    Overloaded,
}

/// Separates the words of a reply from its tool calls. If the request offers tools, a line with a name and a JSON object, as in
/// `step {"way": 1}`, is a call.
pub(super) fn split_tool_calls(text: String, request: &Value) -> (String, Vec<(String, Value)>) {
    let has_tools = request.get("tools").and_then(Value::as_array).is_some_and(|tools| !tools.is_empty());
    if !has_tools {
        return (text, Vec::new());
    }
    let call = |line: &str| {
        let (name, arguments) = line.split_once(' ')?;
        let arguments: Value = serde_json::from_str(arguments).ok()?;
        arguments.is_object().then(|| (name.to_owned(), arguments))
    };
    let (calls, words): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| call(line).is_some());
    (words.join("\n"), calls.into_iter().filter_map(call).collect())
}

/// A refusal in words, for dialects without a field for refusals.
const REFUSAL_TEXT: &str = "I'm sorry, but I can't help with that.";

impl ProviderDialect {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::OpenAi, Self::Completions, Self::Anthropic, Self::Gemini, Self::Ollama];

    /// Its name in settings.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::OpenAi => "openai",
            Self::Completions => "completions",
            Self::Anthropic => "anthropic",
            Self::Gemini => "gemini",
            Self::Ollama => "ollama",
        }
    }

    /// The path before all addresses of the API.
    pub(super) fn base_path(self) -> &'static str {
        match self {
            Self::OpenAi | Self::Completions | Self::Anthropic => "/v1",
            Self::Gemini => "/v1beta",
            Self::Ollama => "",
        }
    }

    /// The header of the key, and the text before the key in it.
    pub(super) fn key_header(self) -> (&'static str, &'static str) {
        match self {
            Self::Anthropic => ("x-api-key", ""),
            Self::Gemini => ("x-goog-api-key", ""),
            Self::OpenAi | Self::Completions | Self::Ollama => ("authorization", "Bearer "),
        }
    }

    /// Reads the body of a request, or returns the message of the error. `model` is the model's name if the address contains it.
    pub(super) fn read_request(self, body: &Value, model: Option<&str>) -> Result<ScriptRequest, &'static str> {
        match self {
            Self::OpenAi => openai::read_request(body),
            Self::Completions => completions::read_request(body),
            Self::Anthropic => anthropic::read_request(body),
            Self::Gemini => gemini::read_request(body, model.unwrap_or_default()),
            Self::Ollama => ollama::read_request(body),
        }
    }

    /// The body of a response with a reply.
    pub(super) fn reply_body(self, reply: &ScriptReply) -> Value {
        match self {
            Self::OpenAi => openai::reply_body(reply),
            Self::Completions => completions::reply_body(reply),
            Self::Anthropic => anthropic::reply_body(reply),
            Self::Gemini => gemini::reply_body(reply),
            Self::Ollama => ollama::reply_body(reply),
        }
    }

    /// A reply without an answer in it.
    pub(super) fn no_choices(self) -> Value {
        match self {
            Self::OpenAi | Self::Completions => openai::no_choices(),
            Self::Anthropic => anthropic::no_choices(),
            Self::Gemini => gemini::no_choices(),
            Self::Ollama => ollama::no_choices(),
        }
    }

    /// The body of a response with the list of models.
    pub(super) fn model_list(self, names: &[&str]) -> Value {
        match self {
            Self::OpenAi | Self::Completions => openai::model_list(names),
            Self::Anthropic => anthropic::model_list(names),
            Self::Gemini => gemini::model_list(names),
            Self::Ollama => ollama::model_list(names),
        }
    }

    /// The body of a response with an error. `details` are added where the dialect has a field for them.
    pub(super) fn error_body(self, kind: ServiceErrorKind, message: &str, details: Option<Value>) -> Value {
        match self {
            Self::OpenAi | Self::Completions => openai::error_body(kind, message, details),
            Self::Anthropic => anthropic::error_body(kind, message, details),
            Self::Gemini => gemini::error_body(kind, message, details, self.status_code(kind)),
            Self::Ollama => ollama::error_body(message),
        }
    }

    /// An error as a response with its HTTP status.
    pub(super) fn error_response(self, kind: ServiceErrorKind, message: &str) -> Response {
        self.error_response_with(kind, message, Vec::new(), None)
    }

    /// A 429 that announces the wait in the given form.
    pub(super) fn too_many(self, form: RetryAfter, wait: Duration) -> Response {
        let message = "Rate limit reached: too many requests.";
        let headers = match form {
            RetryAfter::Reset if self == Self::Anthropic => anthropic::reset_headers(end_of_wait(wait)),
            _ => form.response_headers(wait),
        };
        self.error_response_with(ServiceErrorKind::TooMany, message, headers, form.error_details(wait))
    }

    fn error_response_with(
        self,
        kind: ServiceErrorKind,
        message: &str,
        headers: Vec<(&'static str, String)>,
        details: Option<Value>,
    ) -> Response {
        let status = StatusCode::from_u16(self.status_code(kind)).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        let body = self.error_body(kind, message, details).to_string();
        let mut response = (status, [(header::CONTENT_TYPE, "application/json")], body).into_response();
        for (name, value) in headers {
            if let Ok(value) = HeaderValue::from_str(&value) {
                response.headers_mut().insert(HeaderName::from_static(name), value);
            }
        }
        response
    }

    fn status_code(self, kind: ServiceErrorKind) -> u16 {
        match kind {
            ServiceErrorKind::Request => 400,
            ServiceErrorKind::Key => 401,
            ServiceErrorKind::Model => 404,
            // Some services answer something other than 429 when the account is empty.
            ServiceErrorKind::Quota if self == Self::Anthropic => 400,
            ServiceErrorKind::Quota if self == Self::Ollama => 402,
            ServiceErrorKind::Quota | ServiceErrorKind::TooMany => 429,
            ServiceErrorKind::Server => 500,
            ServiceErrorKind::Unavailable => 503,
            ServiceErrorKind::Overloaded => 529,
        }
    }

    /// The message that the account is empty.
    pub(super) fn quota_message(self) -> &'static str {
        match self {
            Self::Anthropic => "Your credit balance is too low to access the Anthropic API.",
            _ => "You exceeded your current quota, please check your plan and billing details.",
        }
    }
}

//! The dialects of providers, one file each: how to read a request, and how to write replies, errors and lists of models.

mod anthropic;
mod completions;
mod gemini;
mod ollama;
mod openai;
mod parts;

use super::{Heard, RetryAfter};
use axum::{
    http::{HeaderName, HeaderValue, StatusCode, header},
    response::{IntoResponse, Response},
};
use serde_json::Value;
use std::time::Duration;

/// The API of a provider.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialect {
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
pub(super) struct Said {
    pub(super) model: String,
    pub(super) text: String,
    /// Calls of tools: name and arguments. They are not in the text.
    pub(super) calls: Vec<(String, Value)>,
    pub(super) end: End,
    /// Tokens of the request that are billed: one for four bytes of text, and a fixed number for each picture.
    pub(super) tokens_in: u64,
    /// Tokens of the reply that are billed.
    pub(super) tokens_out: u64,
}

/// Why a reply ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum End {
    Stop,
    Length,
    Filtered,
    Refused,
}

/// The kinds of errors that a service reports, about a request or about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wrong {
    Request,
    Key,
    Model,
    Quota,
    TooMany,
    Server,
    Unavailable,
    Overloaded,
}

/// Separates the words of a reply from its tool calls. If the request offers tools, a line with a name and a JSON object, as in
/// `step {"way": 1}`, is a call.
pub(super) fn with_calls(text: String, request: &Value) -> (String, Vec<(String, Value)>) {
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
const SORRY: &str = "I'm sorry, but I can't help with that.";

impl Dialect {
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

    pub(super) fn heard(self, body: &Value, model: Option<&str>) -> Result<Heard, &'static str> {
        match self {
            Self::OpenAi => openai::heard(body),
            Self::Completions => completions::heard(body),
            Self::Anthropic => anthropic::heard(body),
            Self::Gemini => gemini::heard(body, model.unwrap_or_default()),
            Self::Ollama => ollama::heard(body),
        }
    }

    pub(super) fn answer(self, said: &Said) -> Value {
        match self {
            Self::OpenAi => openai::answer(said),
            Self::Completions => completions::answer(said),
            Self::Anthropic => anthropic::answer(said),
            Self::Gemini => gemini::answer(said),
            Self::Ollama => ollama::answer(said),
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

    pub(super) fn models(self, names: &[&str]) -> Value {
        match self {
            Self::OpenAi | Self::Completions => openai::models(names),
            Self::Anthropic => anthropic::models(names),
            Self::Gemini => gemini::models(names),
            Self::Ollama => ollama::models(names),
        }
    }

    pub(super) fn error(self, wrong: Wrong, message: &str, details: Option<Value>) -> Value {
        match self {
            Self::OpenAi | Self::Completions => openai::error(wrong, message, details),
            Self::Anthropic => anthropic::error(wrong, message, details),
            Self::Gemini => gemini::error(wrong, message, details, self.status(wrong)),
            Self::Ollama => ollama::error(message),
        }
    }

    /// An error as a response with its HTTP status.
    pub(super) fn refuse(self, wrong: Wrong, message: &str) -> Response {
        self.refusal(wrong, message, Vec::new(), None)
    }

    /// A 429 that announces the wait in the given form.
    pub(super) fn too_many(self, form: RetryAfter, wait: Duration) -> Response {
        let message = "Rate limit reached: too many requests.";
        self.refusal(Wrong::TooMany, message, form.headers(wait, self), form.details(wait))
    }

    fn refusal(
        self,
        wrong: Wrong,
        message: &str,
        headers: Vec<(&'static str, String)>,
        details: Option<Value>,
    ) -> Response {
        let status = StatusCode::from_u16(self.status(wrong)).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        let body = self.error(wrong, message, details).to_string();
        let mut response = (status, [(header::CONTENT_TYPE, "application/json")], body).into_response();
        for (name, value) in headers {
            if let Ok(value) = HeaderValue::from_str(&value) {
                response.headers_mut().insert(HeaderName::from_static(name), value);
            }
        }
        response
    }

    fn status(self, wrong: Wrong) -> u16 {
        match wrong {
            Wrong::Request => 400,
            Wrong::Key => 401,
            Wrong::Model => 404,
            // Some services answer something other than 429 when the account is empty.
            Wrong::Quota if self == Self::Anthropic => 400,
            Wrong::Quota if self == Self::Ollama => 402,
            Wrong::Quota | Wrong::TooMany => 429,
            Wrong::Server => 500,
            Wrong::Unavailable => 503,
            Wrong::Overloaded => 529,
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

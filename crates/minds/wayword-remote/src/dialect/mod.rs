//! What services speak: one file per dialect, each with two pure functions, request to wire and wire to reply.

mod anthropic;
mod chat;
mod completions;
mod gemini;
mod ollama;

use crate::{picture::Picture, provider::Provider};
use serde::Deserialize;
use serde_json::{Map, Value};
use std::sync::Arc;
use wayword_core::{Role, Sampling};

/// What a service speaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Dialect {
    /// OpenAI's chat completions, which most servers speak too.
    #[serde(rename = "openai")]
    OpenAi,
    /// OpenAI's legacy completions: one prompt, no pictures.
    Completions,
    /// Anthropic's messages.
    Anthropic,
    /// Gemini's `generateContent`.
    Gemini,
    /// Ollama's own `/api/chat`.
    Ollama,
}

/// A message that is ready for the wire.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    pub(crate) role: Role,
    pub(crate) text: String,
    pub(crate) picture: Option<Arc<Picture>>,
}

/// What is asked of a model.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Asked<'a> {
    pub(crate) provider: &'a Provider,
    pub(crate) model: &'a str,
    pub(crate) lines: &'a [Line],
    pub(crate) sampling: &'a Sampling,
}

/// A request as it is sent, less the key.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Wire {
    /// Below the base URL.
    pub(crate) path: String,
    pub(crate) body: Value,
}

/// What came back.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Heard {
    /// Without thinking.
    pub(crate) text: String,
    pub(crate) end: End,
    pub(crate) tokens_in: Option<u64>,
    pub(crate) tokens_out: Option<u64>,
}

/// Why a reply ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum End {
    Stop,
    Length,
    /// The service's filter cut it off or kept it back: why.
    Filtered(String),
    /// The model would not.
    Refused(String),
}

/// What a reply lacks that every reply has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Missing(pub(crate) &'static str);

impl Dialect {
    /// What a base URL without a path is completed with.
    pub(crate) fn version(self) -> &'static str {
        match self {
            Self::Anthropic => "/v1",
            Self::Gemini => "/v1beta",
            Self::OpenAi | Self::Completions | Self::Ollama => "",
        }
    }

    /// Name of the header that carries the key, and what stands before the key in it.
    pub(crate) fn key_header(self) -> (&'static str, &'static str) {
        match self {
            Self::Anthropic => ("x-api-key", ""),
            Self::Gemini => ("x-goog-api-key", ""),
            Self::OpenAi | Self::Completions | Self::Ollama => ("authorization", "Bearer "),
        }
    }

    /// Headers that every request has, besides the key.
    pub(crate) fn headers(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Anthropic => &[("anthropic-version", anthropic::VERSION)],
            _ => &[],
        }
    }

    /// Its name in settings, errors and the ledger.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::OpenAi => "openai",
            Self::Completions => "completions",
            Self::Anthropic => "anthropic",
            Self::Gemini => "gemini",
            Self::Ollama => "ollama",
        }
    }

    /// A request in this dialect.
    ///
    /// # Errors
    /// When it cannot say that: pictures in plain completions.
    pub(crate) fn to_wire(self, asked: Asked<'_>) -> Result<Wire, &'static str> {
        let mut wire = match self {
            Self::OpenAi => chat::to_wire(asked),
            Self::Completions => completions::to_wire(asked)?,
            Self::Anthropic => anthropic::to_wire(asked),
            Self::Gemini => gemini::to_wire(asked),
            Self::Ollama => ollama::to_wire(asked),
        };
        merge(&mut wire.body, &asked.provider.extra);
        Ok(wire)
    }

    /// What a reply says, without the model's thinking.
    ///
    /// # Errors
    /// When it has no answer in it.
    pub(crate) fn heard(self, body: &Value) -> Result<Heard, Missing> {
        let mut heard = match self {
            Self::OpenAi => chat::from_wire(body),
            Self::Completions => completions::from_wire(body),
            Self::Anthropic => anthropic::from_wire(body),
            Self::Gemini => gemini::from_wire(body),
            Self::Ollama => ollama::from_wire(body),
        }?;
        heard.text = after_thinking(&heard.text).trim().to_owned();
        Ok(heard)
    }

    /// Where the models that a service has are listed.
    pub(crate) fn models_path(self) -> &'static str {
        match self {
            Self::OpenAi | Self::Completions => "/models",
            Self::Anthropic => "/models?limit=1000",
            Self::Gemini => "/models?pageSize=1000",
            Self::Ollama => "/api/tags",
        }
    }

    /// The models of such a list.
    pub(crate) fn models(self, body: &Value) -> Option<Vec<&str>> {
        let (list, name) = match self {
            Self::OpenAi | Self::Completions | Self::Anthropic => ("data", "id"),
            Self::Gemini | Self::Ollama => ("models", "name"),
        };
        let list = body.get(list)?.as_array()?;
        Some(
            list.iter()
                .filter_map(|model| model.get(name)?.as_str())
                .map(|name| name.trim_start_matches("models/"))
                .collect(),
        )
    }

    /// How a user keeps a model from spending its tokens on thinking.
    pub(crate) fn without_thinking(self) -> &'static str {
        match self {
            Self::OpenAi | Self::Completions => {
                "extra = { reasoning_effort = \"minimal\" } (\"none\" or \"low\" for some models)"
            }
            Self::Anthropic => "extra = { thinking = { type = \"disabled\" } }",
            Self::Gemini => "extra = { generationConfig = { thinkingConfig = { thinkingBudget = 0 } } }",
            Self::Ollama => "extra = { think = false } (or \"low\" for models that always think)",
        }
    }
}

/// A text without the thinking at its beginning.
///
/// Some servers open the thinking in their prompt template, so that only its end is in the text.
fn after_thinking(text: &str) -> &str {
    const OPEN: &str = "<think>";
    const CLOSE: &str = "</think>";
    let text = text.trim_start();
    match (text.strip_prefix(OPEN), text.find(CLOSE)) {
        (Some(_), Some(at)) => &text[at + CLOSE.len()..],
        // Cut off while it was still thinking.
        (Some(_), None) => "",
        (None, Some(at)) if !text[..at].contains(OPEN) => &text[at + CLOSE.len()..],
        _ => text,
    }
}

/// Seeds as every service takes them: 31 bits.
fn seed(sampling: &Sampling) -> u64 {
    sampling.seed & 0x7fff_ffff
}

/// Puts a user's fields into a body; tables are merged, everything else is replaced.
fn merge(body: &mut Value, extra: &Map<String, Value>) {
    let Value::Object(body) = body else { return };
    for (field, value) in extra {
        match (body.get_mut(field), value) {
            (Some(inner @ Value::Object(_)), Value::Object(extra)) => merge(inner, extra),
            _ => {
                body.insert(field.clone(), value.clone());
            }
        }
    }
}

/// The texts of a message's content: a string, or parts of which those of type `text` count.
fn content(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(parts) => parts
            .iter()
            .filter(|part| part.get("type").and_then(Value::as_str) == Some("text"))
            .filter_map(|part| part.get("text")?.as_str())
            .collect(),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests;

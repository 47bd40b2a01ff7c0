//! The APIs of services. Each dialect is one file with two pure functions: `to_wire` makes a request's body,
//! `from_wire` reads a reply's body.

mod anthropic;
mod chat;
mod completions;
mod gemini;
mod ollama;

use crate::{JsonMode, ServiceDialect, picture::EncodedPicture, provider::RemoteProvider};
use serde_json::{Map, Value};
use std::sync::Arc;
use wayword_core::{MessageRole, ModelTool, ReplySchema, SamplingOptions, tool_line};
use wayword_replies::without_thinking;

/// A message that is ready to be sent.
#[derive(Debug, Clone)]
pub(crate) struct RemoteMessage {
    pub(crate) role: MessageRole,
    pub(crate) text: String,
    pub(crate) pictures: Vec<Arc<EncodedPicture>>,
}

/// A request to a model.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DialectRequest<'a> {
    pub(crate) provider: &'a RemoteProvider,
    /// The name of the model at the provider.
    pub(crate) model: &'a str,
    /// The messages so far, the last of which is to be answered.
    pub(crate) lines: &'a [RemoteMessage],
    pub(crate) sampling: &'a SamplingOptions,
    /// The form of the reply, where it is to be JSON.
    pub(crate) schema: Option<ReplySchema>,
    /// The tools that the model may call.
    pub(crate) tools: &'static [ModelTool],
    /// An estimate of the tokens that the request takes, with the reply. Only Ollama has to be told.
    pub(crate) context_tokens: u64,
}

/// A request as it is sent, without the key.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct WireRequest {
    /// The path after the base URL.
    pub(crate) path: String,
    pub(crate) body: Value,
}

/// A model's reply.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct DialectReply {
    /// The text, without the model's thinking. Each call of a tool is a line at its end.
    pub(crate) text: String,
    pub(crate) end: ReplyEnd,
    /// The tokens of the request and of the reply, if the service reports them.
    pub(crate) tokens_in: Option<u64>,
    pub(crate) tokens_out: Option<u64>,
}

/// Why a reply ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum ReplyEnd {
    /// The model was finished.
    Stop,
    /// The model was finished, but all that it wrote stands where the service keeps its thoughts.
    Thought,
    /// The reply reached the most tokens.
    Length,
    /// The service's filter cut the reply off or blocked it, with the reason.
    Filtered(String),
    /// The model refused, with its words.
    Refused(String),
}

impl DialectReply {
    /// The text for the one who asked. A refusal in a field of its own is told in words that every role knows.
    pub(crate) fn answer(&self) -> String {
        match &self.end {
            ReplyEnd::Refused(why) => format!("I'm sorry, I can't help with that: {}", why.trim()),
            _ => self.text.clone(),
        }
    }
}

/// The name of a field that every reply must have and this one lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct MissingField(pub(crate) &'static str);

impl ServiceDialect {
    /// The name of the header with the key, and the text before the key in it.
    pub(crate) fn key_header(self) -> (&'static str, &'static str) {
        match self {
            Self::Anthropic => ("x-api-key", ""),
            Self::Gemini => ("x-goog-api-key", ""),
            Self::OpenAi | Self::Completions | Self::Ollama => ("authorization", "Bearer "),
        }
    }

    /// Headers of every request, in addition to the key's.
    pub(crate) fn extra_headers(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Anthropic => &[("anthropic-version", anthropic::API_VERSION)],
            _ => &[],
        }
    }

    /// A request in this dialect.
    ///
    /// # Errors
    /// When the dialect cannot express it: completions take no pictures.
    pub(crate) fn to_wire(self, request: DialectRequest<'_>) -> Result<WireRequest, &'static str> {
        let mut wire = match self {
            Self::OpenAi => chat::to_wire(request),
            Self::Completions => completions::to_wire(request)?,
            Self::Anthropic => anthropic::to_wire(request),
            Self::Gemini => gemini::to_wire(request),
            Self::Ollama => ollama::to_wire(request),
        };
        merge_fields(&mut wire.body, &request.provider.extra);
        Ok(wire)
    }

    /// Reads a reply, without the model's thinking.
    ///
    /// # Errors
    /// When it has no answer.
    pub(crate) fn read_reply(self, body: &Value) -> Result<DialectReply, MissingField> {
        let mut reply = match self {
            Self::OpenAi => chat::from_wire(body),
            Self::Completions => completions::from_wire(body),
            Self::Anthropic => anthropic::from_wire(body),
            Self::Gemini => gemini::from_wire(body),
            Self::Ollama => ollama::from_wire(body),
        }?;
        let calls = match self {
            Self::OpenAi => chat::tool_calls(body),
            Self::Anthropic => anthropic::tool_calls(body),
            Self::Gemini => gemini::tool_calls(body),
            Self::Ollama => ollama::tool_calls(body),
            Self::Completions => Vec::new(),
        };
        let words = without_thinking(&reply.text);
        if words.is_empty() && !calls.is_empty() && reply.end == ReplyEnd::Thought {
            reply.end = ReplyEnd::Stop;
        }
        let lines: Vec<&str> = [words.as_str()].into_iter().chain(calls.iter().map(String::as_str)).collect();
        reply.text = lines.join("\n").trim().to_owned();
        Ok(reply)
    }

    /// The path of the service's list of models.
    pub(crate) fn models_path(self) -> &'static str {
        match self {
            Self::OpenAi | Self::Completions => "/models",
            Self::Anthropic => "/models?limit=1000",
            Self::Gemini => "/models?pageSize=1000",
            Self::Ollama => "/api/tags",
        }
    }

    /// The request for a model's capabilities, for services that have one.
    pub(crate) fn to_describe(self, model: &str) -> Option<WireRequest> {
        (self == Self::Ollama).then(|| ollama::to_describe(model))
    }

    /// Whether a model takes pictures, by its service's description of it; `None` where the description has no answer.
    pub(crate) fn describes_sight(self, body: &Value) -> Option<bool> {
        if self == Self::Ollama { ollama::describes_sight(body) } else { None }
    }

    /// The models in the service's list.
    pub(crate) fn listed_models(self, body: &Value) -> Option<Vec<&str>> {
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

    /// The setting with which a service reads longer prompts.
    pub(crate) fn longer_context(self) -> &'static str {
        match self {
            Self::Ollama => "set context_tokens = 32768",
            _ => "start the server with a longer context, or set context_tokens to what it has",
        }
    }

    /// The setting that keeps a model from spending its tokens on thinking.
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

/// A seed of 31 bits, which every service takes.
fn seed_of_31_bits(sampling: &SamplingOptions) -> u64 {
    sampling.seed & 0x7fff_ffff
}

/// A call of a tool as a line. Some services give the arguments as an object, others as a text with JSON.
fn tool_call_line(name: Option<&Value>, arguments: Option<&Value>) -> Option<String> {
    let arguments = match arguments {
        Some(Value::String(text)) => match serde_json::from_str::<Value>(text) {
            // Some services encode the text once more.
            Ok(Value::String(inner)) => inner,
            Ok(value) => value.to_string(),
            Err(_) => text.split("<|").next().unwrap_or(text).to_owned(),
        },
        Some(Value::Null) | None => "{}".to_owned(),
        Some(value) => value.to_string(),
    };
    // Some servers leave the marks of the model's template in the name.
    let name = name?.as_str()?.split("<").next()?;
    Some(tool_line(name, &arguments))
}

impl DialectRequest<'_> {
    /// Each tool of the request with the schema of its arguments; none where the service has no tool calls.
    fn callable_tools(&self) -> Vec<(&'static ModelTool, Value)> {
        let tools = self.tools.iter().filter(|_| self.provider.tools);
        tools.filter_map(|tool| Some((tool, serde_json::from_str(tool.arguments).ok()?))).collect()
    }

    /// How the request asks for JSON: the mode, the schema's name, and the schema. `None` if only the prompt asks for
    /// it.
    fn json_form(&self) -> Option<(JsonMode, &'static str, Value)> {
        let schema = self.schema.filter(|_| self.provider.json != JsonMode::Prompt)?;
        Some((self.provider.json, schema.name, serde_json::from_str(schema.json).ok()?))
    }
}

/// Puts a user's fields into a body. Tables are merged, all other values are replaced.
fn merge_fields(body: &mut Value, extra: &Map<String, Value>) {
    let Value::Object(body) = body else { return };
    for (field, value) in extra {
        match (body.get_mut(field), value) {
            (Some(inner @ Value::Object(_)), Value::Object(extra)) => merge_fields(inner, extra),
            _ => {
                body.insert(field.clone(), value.clone());
            }
        }
    }
}

/// The text of a message's content: a string, or the parts of type `text`.
fn content_text(value: &Value) -> String {
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

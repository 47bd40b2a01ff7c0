//! Ollama's own chat endpoint (<https://github.com/ollama/ollama/blob/main/docs/api.md>).

use super::{Asked, End, Heard, Line, Missing, Wire, chat, seed};
use crate::Json;
use serde_json::{Map, Value, json};
use wayword_core::Role;

/// Turns a request into a body for this API.
pub(super) fn to_wire(asked: Asked<'_>) -> Wire {
    let (provider, sampling) = (asked.provider, asked.sampling);
    let mut options = Map::new();
    if provider.sends("temperature") {
        options.insert("temperature".to_owned(), sampling.temperature.into());
    }
    if provider.sends("max_tokens") {
        options.insert("num_predict".to_owned(), sampling.max_tokens.into());
    }
    if provider.sends("seed") {
        options.insert("seed".to_owned(), seed(sampling).into());
    }
    let messages: Vec<Value> = asked.lines.iter().map(message).collect();
    let mut body = json!({ "model": asked.model, "messages": messages, "stream": false, "options": options });
    if let Some((way, _, schema)) = asked.json() {
        body["format"] = if way == Json::Schema { schema } else { "json".into() };
    }
    let tools = chat::tools(asked);
    if !tools.is_empty() {
        body["tools"] = tools.into();
    }
    Wire { path: "/api/chat".to_owned(), body }
}

/// The tools that a reply calls, each as a line.
pub(super) fn tool_calls(body: &Value) -> Vec<String> {
    body.get("message").map(chat::calls_of).unwrap_or_default()
}

fn message(line: &Line) -> Value {
    let role = match line.role {
        Role::System => "system",
        Role::User => "user",
        Role::Assistant => "assistant",
    };
    let mut message = json!({ "role": role, "content": line.text });
    if let (false, Value::Object(message)) = (line.pictures.is_empty(), &mut message) {
        let pictures = line.pictures.iter().map(|picture| Value::from(picture.base64.as_str()));
        message.insert("images".to_owned(), pictures.collect());
    }
    message
}

/// Reads a reply's body.
pub(super) fn from_wire(body: &Value) -> Result<Heard, Missing> {
    let text = body.get("message").and_then(|message| message.get("content")?.as_str()).ok_or(Missing("message"))?;
    let end = if body.get("done_reason").and_then(Value::as_str) == Some("length") { End::Length } else { End::Stop };
    let tokens = |field: &str| body.get(field)?.as_u64();
    Ok(Heard { text: text.to_owned(), end, tokens_in: tokens("prompt_eval_count"), tokens_out: tokens("eval_count") })
}

/// The request for a model's capabilities.
pub(super) fn to_describe(model: &str) -> Wire {
    Wire { path: "/api/show".to_owned(), body: json!({ "model": model }) }
}

/// Whether `vision` is among a model's capabilities. Servers before 0.6.4 do not list them.
pub(super) fn describes_sight(body: &Value) -> Option<bool> {
    let capabilities = body.get("capabilities")?.as_array()?;
    Some(capabilities.iter().any(|capability| capability.as_str() == Some("vision")))
}

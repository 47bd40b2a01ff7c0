//! Anthropic's messages (<https://docs.anthropic.com/en/api/messages>).

use super::{
    DialectReply, DialectRequest, MissingField, RemoteMessage, ReplyEnd, WireRequest, content_text, tool_call_line,
};
use crate::picture::EncodedPicture;
use serde_json::{Map, Value, json};
use std::sync::Arc;
use wayword_core::{MessageRole, ModelTool};

/// The version of the API that this file implements.
pub(super) const API_VERSION: &str = "2023-06-01";

/// Turns a request into a body for this API.
pub(super) fn to_wire(request: DialectRequest<'_>) -> WireRequest {
    let system: Vec<&str> =
        request.lines.iter().filter(|line| line.role == MessageRole::System).map(|line| line.text.as_str()).collect();
    let mut body = Map::new();
    body.insert("model".to_owned(), request.model.into());
    // `omit` does not apply: the service refuses a request without this field.
    body.insert("max_tokens".to_owned(), request.sampling.max_tokens.into());
    if !system.is_empty() {
        body.insert("system".to_owned(), system.join("\n\n").into());
    }
    let conversation = request.lines.iter().filter(|line| line.role != MessageRole::System);
    body.insert("messages".to_owned(), conversation.map(message_json).collect());
    if request.provider.sends_field("temperature") {
        body.insert("temperature".to_owned(), request.sampling.temperature.clamp(0.0, 1.0).into());
    }
    let tool = |(tool, arguments): (&'static ModelTool, Value)| json!({ "name": tool.name, "description": tool.does, "input_schema": arguments });
    let tools: Vec<Value> = request.callable_tools().into_iter().map(tool).collect();
    if !tools.is_empty() {
        body.insert("tools".to_owned(), tools.into());
        body.insert("tool_choice".to_owned(), json!({ "type": "any" }));
    }
    WireRequest { path: "/messages".to_owned(), body: body.into() }
}

/// The tools that a reply calls, each as a line.
pub(super) fn tool_calls(body: &Value) -> Vec<String> {
    let parts = body.get("content").and_then(Value::as_array).into_iter().flatten();
    let calls = parts.filter(|part| part.get("type").and_then(Value::as_str) == Some("tool_use"));
    calls.filter_map(|part| tool_call_line(part.get("name"), part.get("input"))).collect()
}

/// A message in the form of this API.
fn message_json(line: &RemoteMessage) -> Value {
    let role = if line.role == MessageRole::Assistant { "assistant" } else { "user" };
    if line.pictures.is_empty() {
        return json!({ "role": role, "content": line.text });
    }
    let picture = |picture: &Arc<EncodedPicture>| {
        let source = json!({ "type": "base64", "media_type": "image/jpeg", "data": picture.base64 });
        json!({ "type": "image", "source": source })
    };
    let mut parts: Vec<Value> = line.pictures.iter().map(picture).collect();
    // The service refuses an empty text block.
    if !line.text.is_empty() {
        parts.push(json!({ "type": "text", "text": line.text }));
    }
    json!({ "role": role, "content": parts })
}

/// Reads a reply's body.
pub(super) fn from_wire(body: &Value) -> Result<DialectReply, MissingField> {
    let text = content_text(body.get("content").filter(|parts| parts.is_array()).ok_or(MissingField("content"))?);
    let end = match body.get("stop_reason").and_then(Value::as_str) {
        Some("max_tokens" | "model_context_window_exceeded") => ReplyEnd::Length,
        Some("refusal") => ReplyEnd::Refused("refusal".to_owned()),
        _ => ReplyEnd::Stop,
    };
    let tokens = |field: &str| body.get("usage")?.get(field)?.as_u64();
    Ok(DialectReply { text, end, tokens_in: tokens("input_tokens"), tokens_out: tokens("output_tokens") })
}

//! Ollama's own chat endpoint (<https://github.com/ollama/ollama/blob/main/docs/api.md>).

use super::{DialectReply, DialectRequest, MissingField, RemoteMessage, ReplyEnd, WireRequest, chat, seed_of_31_bits};
use crate::JsonMode;
use serde_json::{Map, Value, json};
use wayword_core::MessageRole;

/// Turns a request into a body for this API.
pub(super) fn to_wire(request: DialectRequest<'_>) -> WireRequest {
    let (provider, sampling) = (request.provider, request.sampling);
    let mut options = Map::new();
    if provider.sends_field("temperature") {
        options.insert("temperature".to_owned(), sampling.temperature.into());
    }
    if provider.sends_field("max_tokens") {
        options.insert("num_predict".to_owned(), sampling.max_tokens.into());
    }
    if provider.sends_field("seed") {
        options.insert("seed".to_owned(), seed_of_31_bits(sampling).into());
    }
    // Ollama cuts a prompt that is longer than this without a word; its own default is 4,096 or less.
    let context = provider.context_tokens.unwrap_or_else(|| context_size(request.context_tokens));
    options.insert("num_ctx".to_owned(), context.into());
    let messages: Vec<Value> = request.lines.iter().map(message_json).collect();
    let mut body = json!({ "model": request.model, "messages": messages, "stream": false, "options": options });
    if let Some((way, _, schema)) = request.json_form() {
        body["format"] = if way == JsonMode::Schema { schema } else { "json".into() };
    }
    let tools = chat::tools_json(request);
    if !tools.is_empty() {
        body["tools"] = tools.into();
    }
    WireRequest { path: "/api/chat".to_owned(), body }
}

/// The least context that is asked for, tokens. Ollama loads a model again for another size, so there are few sizes.
const MIN_CONTEXT: u64 = 8_192;

/// The context to ask for, tokens: the least size that holds the request. Ollama bounds it by what the model takes.
pub(super) fn context_size(tokens: u64) -> u64 {
    tokens.next_power_of_two().max(MIN_CONTEXT)
}

/// The tools that a reply calls, each as a line.
pub(super) fn tool_calls(body: &Value) -> Vec<String> {
    body.get("message").map(chat::message_tool_calls).unwrap_or_default()
}

/// A message in the form of this API.
fn message_json(line: &RemoteMessage) -> Value {
    let role = match line.role {
        MessageRole::System => "system",
        MessageRole::User => "user",
        MessageRole::Assistant => "assistant",
    };
    let mut message = json!({ "role": role, "content": line.text });
    if let (false, Value::Object(message)) = (line.pictures.is_empty(), &mut message) {
        let pictures = line.pictures.iter().map(|picture| Value::from(picture.base64.as_str()));
        message.insert("images".to_owned(), pictures.collect());
    }
    message
}

/// Reads a reply's body.
pub(super) fn from_wire(body: &Value) -> Result<DialectReply, MissingField> {
    let text =
        body.get("message").and_then(|message| message.get("content")?.as_str()).ok_or(MissingField("message"))?;
    let end = if body.get("done_reason").and_then(Value::as_str) == Some("length") {
        ReplyEnd::Length
    } else {
        ReplyEnd::Stop
    };
    let tokens = |field: &str| body.get(field)?.as_u64();
    Ok(DialectReply {
        text: text.to_owned(),
        end,
        tokens_in: tokens("prompt_eval_count"),
        tokens_out: tokens("eval_count"),
    })
}

/// The request for a model's capabilities.
pub(super) fn to_describe(model: &str) -> WireRequest {
    WireRequest { path: "/api/show".to_owned(), body: json!({ "model": model }) }
}

/// Whether `vision` is among a model's capabilities. Servers before 0.6.4 do not list them.
pub(super) fn describes_sight(body: &Value) -> Option<bool> {
    let capabilities = body.get("capabilities")?.as_array()?;
    Some(capabilities.iter().any(|capability| capability.as_str() == Some("vision")))
}

//! Gemini's `generateContent` (<https://ai.google.dev/api/generate-content>).

use super::{
    DialectReply, DialectRequest, MissingField, RemoteMessage, ReplyEnd, WireRequest, seed_of_31_bits, tool_call_line,
};
use crate::JsonMode;
use serde_json::{Map, Value, json};
use wayword_core::{MessageRole, ModelTool};

/// Turns a request into a body for this API.
pub(super) fn to_wire(request: DialectRequest<'_>) -> WireRequest {
    let (provider, sampling) = (request.provider, request.sampling);
    let mut body = Map::new();
    let system: Vec<Value> = request
        .lines
        .iter()
        .filter(|line| line.role == MessageRole::System)
        .map(|line| json!({ "text": line.text }))
        .collect();
    if !system.is_empty() {
        body.insert("systemInstruction".to_owned(), json!({ "parts": system }));
    }
    let conversation = request.lines.iter().filter(|line| line.role != MessageRole::System);
    body.insert("contents".to_owned(), conversation.map(message_json).collect());
    let mut generation = Map::new();
    if provider.sends_field("temperature") {
        generation.insert("temperature".to_owned(), sampling.temperature.into());
    }
    if provider.sends_field("max_tokens") {
        generation.insert("maxOutputTokens".to_owned(), sampling.max_tokens.into());
    }
    if provider.sends_field("seed") {
        generation.insert("seed".to_owned(), seed_of_31_bits(sampling).into());
    }
    if let Some((way, _, mut schema)) = request.json_form() {
        generation.insert("responseMimeType".to_owned(), "application/json".into());
        if way == JsonMode::Schema {
            to_open_api(&mut schema);
            generation.insert("responseSchema".to_owned(), schema);
        }
    }
    body.insert("generationConfig".to_owned(), generation.into());
    let tool = |(tool, mut arguments): (&'static ModelTool, Value)| {
        to_open_api(&mut arguments);
        json!({ "name": tool.name, "description": tool.does, "parameters": arguments })
    };
    let tools: Vec<Value> = request.callable_tools().into_iter().map(tool).collect();
    if !tools.is_empty() {
        body.insert("tools".to_owned(), json!([{ "functionDeclarations": tools }]));
        body.insert("toolConfig".to_owned(), json!({ "functionCallingConfig": { "mode": "ANY" } }));
    }
    WireRequest { path: format!("/models/{}:generateContent", encode_model_name(request.model)), body: body.into() }
}

/// Rewrites a JSON schema into the subset of OpenAPI that the service reads: types in capitals, and no
/// `additionalProperties`.
fn to_open_api(schema: &mut Value) {
    match schema {
        Value::Object(fields) => {
            fields.remove("additionalProperties");
            if let Some(Value::String(kind)) = fields.get_mut("type") {
                kind.make_ascii_uppercase();
            }
            fields.values_mut().for_each(to_open_api);
        }
        Value::Array(values) => values.iter_mut().for_each(to_open_api),
        _ => {}
    }
}

/// A message in the form of this API.
fn message_json(line: &RemoteMessage) -> Value {
    let role = if line.role == MessageRole::Assistant { "model" } else { "user" };
    let mut parts = vec![json!({ "text": line.text })];
    let inline = |data: &str| json!({ "inlineData": { "mimeType": "image/jpeg", "data": data } });
    parts.extend(line.pictures.iter().map(|picture| inline(&picture.base64)));
    json!({ "role": role, "parts": parts })
}

/// A model's name, encoded as a part of an address.
fn encode_model_name(model: &str) -> String {
    let keep = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~".contains(&byte);
    let model = model.strip_prefix("models/").unwrap_or(model);
    model.bytes().map(|byte| if keep(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") }).collect()
}

/// The tools that a reply calls, each as a line.
pub(super) fn tool_calls(body: &Value) -> Vec<String> {
    let candidate = body.get("candidates").and_then(|all| all.get(0));
    let parts = candidate.and_then(|candidate| candidate.get("content")?.get("parts")?.as_array());
    let calls = parts.into_iter().flatten().filter_map(|part| part.get("functionCall"));
    calls.filter_map(|call| tool_call_line(call.get("name"), call.get("args"))).collect()
}

/// Reads a reply's body.
pub(super) fn from_wire(body: &Value) -> Result<DialectReply, MissingField> {
    let tokens = |field: &str| body.get("usageMetadata")?.get(field)?.as_u64();
    let answer_tokens = tokens("candidatesTokenCount");
    let thinking_tokens = tokens("thoughtsTokenCount");
    let tokens_out = answer_tokens
        .or(thinking_tokens)
        .map(|_| answer_tokens.unwrap_or(0).saturating_add(thinking_tokens.unwrap_or(0)));
    let reply = |text, end| DialectReply { text, end, tokens_in: tokens("promptTokenCount"), tokens_out };
    if let Some(why) = body.get("promptFeedback").and_then(|feedback| feedback.get("blockReason")?.as_str()) {
        return Ok(reply(String::new(), ReplyEnd::Filtered(why.to_owned())));
    }
    let candidate = body.get("candidates").and_then(|all| all.get(0)).ok_or(MissingField("candidates"))?;
    let parts = candidate.get("content").and_then(|content| content.get("parts")?.as_array());
    let is_answer = |part: &&Value| part.get("thought").and_then(Value::as_bool) != Some(true);
    let text = parts.into_iter().flatten().filter(is_answer).filter_map(|part| part.get("text")?.as_str()).collect();
    let end = match candidate.get("finishReason").and_then(Value::as_str) {
        Some("MAX_TOKENS") => ReplyEnd::Length,
        Some(
            why @ ("SAFETY" | "RECITATION" | "BLOCKLIST" | "PROHIBITED_CONTENT" | "SPII" | "LANGUAGE" | "IMAGE_SAFETY"),
        ) => ReplyEnd::Filtered(why.to_owned()),
        _ => ReplyEnd::Stop,
    };
    Ok(reply(text, end))
}

//! Reads the parts of requests that several dialects share: texts, lists, roles, pictures and sampling settings.

use super::super::ScriptRequest;
use base64::prelude::{BASE64_STANDARD, Engine};
use serde_json::Value;
use wayword_core::MessageRole;

/// A field that must be a text.
pub(super) fn text_field(body: &Value, field: &str) -> Result<String, &'static str> {
    body.get(field).and_then(Value::as_str).map(str::to_owned).ok_or("A field is missing that must be a text.")
}

/// A field that must be a list with at least one entry.
pub(super) fn list_field<'a>(body: &'a Value, field: &str) -> Result<&'a Vec<Value>, &'static str> {
    body.get(field)
        .and_then(Value::as_array)
        .filter(|list| !list.is_empty())
        .ok_or("A field is missing that must be a list.")
}

/// The role of a message, by the name that any of the dialects gives it.
pub(super) fn message_role(message: &Value) -> Result<MessageRole, &'static str> {
    match message.get("role").and_then(Value::as_str) {
        Some("system" | "developer") => Ok(MessageRole::System),
        Some("user") => Ok(MessageRole::User),
        Some("assistant" | "model") => Ok(MessageRole::Assistant),
        _ => Err("A message has no role that is known."),
    }
}

/// The bytes of a picture file that was sent as base64.
pub(super) fn decode_picture(base64: &str) -> Result<Vec<u8>, &'static str> {
    BASE64_STANDARD.decode(base64).map_err(|_| "A picture is not base64.")
}

/// Takes the sampling settings from `table`; `max_tokens` lists the possible names of that setting.
pub(super) fn read_sampling(request: &mut ScriptRequest, table: &Value, max_tokens: &[&str]) {
    request.temperature = table.get("temperature").and_then(Value::as_f64);
    request.max_tokens = max_tokens.iter().find_map(|name| table.get(name)?.as_u64());
    request.seed = ["seed", "random_seed"].iter().find_map(|name| table.get(name)?.as_u64());
}

//! The dialect of Anthropic's messages API.

use super::{ReplyEnding, ScriptReply, ServiceErrorKind, request_parts};
use crate::provider::ScriptRequest;
use jiff::Timestamp;
use serde_json::{Value, json};
use wayword_core::MessageRole;

pub(super) fn read_request(body: &Value) -> Result<ScriptRequest, &'static str> {
    let mut request = ScriptRequest { model: request_parts::text_field(body, "model")?, ..ScriptRequest::default() };
    if let Some(system) = body.get("system") {
        let text = read_content(system, &mut request.pictures)?;
        request.messages.push((MessageRole::System, text));
    }
    for message in request_parts::list_field(body, "messages")? {
        let role = request_parts::message_role(message)?;
        let text = read_content(message.get("content").unwrap_or(&Value::Null), &mut request.pictures)?;
        request.messages.push((role, text));
    }
    request_parts::read_sampling(&mut request, body, &["max_tokens"]);
    // The service refuses a request without it.
    request.max_tokens.ok_or("max_tokens: Field required")?;
    Ok(request)
}

/// The text of a message, the parts joined by line ends. Its pictures are added to `pictures`.
fn read_content(content: &Value, pictures: &mut Vec<Vec<u8>>) -> Result<String, &'static str> {
    let parts = match content {
        Value::String(text) => return Ok(text.clone()),
        Value::Array(parts) => parts,
        _ => return Err("A message has no content."),
    };
    let mut texts = Vec::new();
    for part in parts {
        match part.get("type").and_then(Value::as_str) {
            Some("text") => texts.push(request_parts::text_field(part, "text")?),
            Some("image") => {
                let source = part.get("source").ok_or("An image has no source.")?;
                pictures.push(request_parts::decode_picture(&request_parts::text_field(source, "data")?)?);
            }
            _ => return Err("A part of a message has no type that is known."),
        }
    }
    Ok(texts.join("\n"))
}

pub(super) fn reply_body(reply: &ScriptReply) -> Value {
    let (content, reason) = match reply.end {
        ReplyEnding::Stop if !reply.calls.is_empty() => {
            let call = |(at, (name, input)): (usize, &(String, Value))| json!({ "type": "tool_use", "id": format!("toolu_{at}"), "name": name, "input": input });
            (reply.calls.iter().enumerate().map(call).collect(), "tool_use")
        }
        ReplyEnding::Stop => (json!([{ "type": "text", "text": reply.text }]), "end_turn"),
        ReplyEnding::Length => (json!([{ "type": "text", "text": reply.text }]), "max_tokens"),
        ReplyEnding::Filtered | ReplyEnding::Refused => (json!([]), "refusal"),
    };
    json!({
        "id": "msg_test", "type": "message", "role": "assistant", "model": reply.model, "content": content,
        "stop_reason": reason, "stop_sequence": null,
        "usage": { "input_tokens": reply.tokens_in, "output_tokens": reply.tokens_out },
    })
}

pub(super) fn no_choices() -> Value {
    json!({ "id": "msg_test", "type": "message", "role": "assistant" })
}

pub(super) fn model_list(names: &[&str]) -> Value {
    let model = |name: &&str| json!({ "type": "model", "id": name, "display_name": name });
    let data: Vec<Value> = names.iter().map(model).collect();
    json!({ "data": data, "has_more": false, "first_id": names.first(), "last_id": names.last() })
}

/// The headers of a 429 that give the moment from which requests are allowed again.
pub(super) fn reset_headers(at: Timestamp) -> Vec<(&'static str, String)> {
    vec![
        ("anthropic-ratelimit-requests-remaining", "0".to_owned()),
        ("anthropic-ratelimit-requests-reset", at.to_string()),
    ]
}

pub(super) fn error_body(error_kind: ServiceErrorKind, message: &str, details: Option<Value>) -> Value {
    let kind = match error_kind {
        ServiceErrorKind::Request | ServiceErrorKind::Quota => "invalid_request_error",
        ServiceErrorKind::Key => "authentication_error",
        ServiceErrorKind::Model => "not_found_error",
        ServiceErrorKind::TooMany => "rate_limit_error",
        ServiceErrorKind::Server | ServiceErrorKind::Unavailable => "api_error",
        ServiceErrorKind::Overloaded => "overloaded_error",
    };
    let mut error = json!({ "type": kind, "message": message });
    if let (Some(details), Some(error)) = (details, error.as_object_mut()) {
        error.insert("details".to_owned(), details);
    }
    json!({ "type": "error", "error": error })
}

//! The dialect of OpenAI's chat completions.

use super::{ReplyEnding, ScriptReply, ServiceErrorKind, request_parts};
use crate::provider::ScriptRequest;
use serde_json::{Value, json};

pub(super) fn read_request(body: &Value) -> Result<ScriptRequest, &'static str> {
    let mut request = ScriptRequest { model: request_parts::text_field(body, "model")?, ..ScriptRequest::default() };
    for message in request_parts::list_field(body, "messages")? {
        let role = request_parts::message_role(message)?;
        let text = read_content(message.get("content").unwrap_or(&Value::Null), &mut request.pictures)?;
        request.messages.push((role, text));
    }
    request_parts::read_sampling(&mut request, body, &["max_completion_tokens", "max_tokens"]);
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
            Some("image_url") => {
                let url = part.get("image_url").and_then(|image| image.get("url")?.as_str());
                let data = url.and_then(|url| url.strip_prefix("data:image/")?.split_once(";base64,"));
                let (_, base64) = data.ok_or("Only data URLs of images are read.")?;
                pictures.push(request_parts::decode_picture(base64)?);
            }
            _ => return Err("A part of a message has no type that is known."),
        }
    }
    Ok(texts.join("\n"))
}

pub(super) fn reply_body(reply: &ScriptReply) -> Value {
    let message = match reply.end {
        ReplyEnding::Stop if !reply.calls.is_empty() => {
            let call = |(at, (name, arguments)): (usize, &(String, Value))| {
                // The arguments are JSON within a text.
                let function = json!({ "name": name, "arguments": arguments.to_string() });
                json!({ "id": format!("call_{at}"), "type": "function", "function": function })
            };
            let calls: Vec<Value> = reply.calls.iter().enumerate().map(call).collect();
            json!({ "role": "assistant", "content": reply.text, "refusal": null, "tool_calls": calls })
        }
        ReplyEnding::Stop | ReplyEnding::Length => {
            json!({ "role": "assistant", "content": reply.text, "refusal": null })
        }
        ReplyEnding::Filtered => json!({ "role": "assistant", "content": "", "refusal": null }),
        ReplyEnding::Refused => json!({ "role": "assistant", "content": null, "refusal": super::REFUSAL_TEXT }),
    };
    let choice = json!({ "index": 0, "message": message, "logprobs": null, "finish_reason": finish_reason(reply.end) });
    wrap_choice(reply, "chat.completion", &choice)
}

/// The service's word for why a reply ends.
pub(super) fn finish_reason(end: ReplyEnding) -> &'static str {
    match end {
        ReplyEnding::Stop | ReplyEnding::Refused => "stop",
        ReplyEnding::Length => "length",
        ReplyEnding::Filtered => "content_filter",
    }
}

/// The body of a reply with one choice. `object` is the service's name for the kind of reply.
pub(super) fn wrap_choice(reply: &ScriptReply, object: &str, choice: &Value) -> Value {
    json!({
        "id": "chatcmpl-test", "object": object, "created": 1_767_225_600, "model": reply.model,
        "choices": [choice],
        "usage": {
            "prompt_tokens": reply.tokens_in, "completion_tokens": reply.tokens_out,
            "total_tokens": reply.tokens_in + reply.tokens_out,
        },
    })
}

pub(super) fn no_choices() -> Value {
    json!({ "id": "chatcmpl-test", "object": "chat.completion", "choices": [] })
}

pub(super) fn model_list(names: &[&str]) -> Value {
    let model = |name: &&str| json!({ "id": name, "object": "model", "created": 1_767_225_600, "owned_by": "test" });
    json!({ "object": "list", "data": names.iter().map(model).collect::<Vec<_>>() })
}

pub(super) fn error_body(error_kind: ServiceErrorKind, message: &str, details: Option<Value>) -> Value {
    let (kind, code) = match error_kind {
        ServiceErrorKind::Request => ("invalid_request_error", Value::Null),
        ServiceErrorKind::Key => ("invalid_request_error", "invalid_api_key".into()),
        ServiceErrorKind::Model => ("invalid_request_error", "model_not_found".into()),
        ServiceErrorKind::Quota => ("insufficient_quota", "insufficient_quota".into()),
        ServiceErrorKind::TooMany => ("requests", "rate_limit_exceeded".into()),
        ServiceErrorKind::Server | ServiceErrorKind::Unavailable | ServiceErrorKind::Overloaded => {
            ("server_error", Value::Null)
        }
    };
    let mut error = json!({ "message": message, "type": kind, "param": null, "code": code });
    if let (Some(details), Some(error)) = (details, error.as_object_mut()) {
        error.insert("details".to_owned(), details);
    }
    json!({ "error": error })
}

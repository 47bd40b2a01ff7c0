//! The dialect of OpenAI's chat completions.

use super::{End, Said, Wrong, parts};
use crate::provider::Heard;
use serde_json::{Value, json};

pub(super) fn heard(body: &Value) -> Result<Heard, &'static str> {
    let mut heard = Heard { model: parts::text(body, "model")?, ..Heard::default() };
    for message in parts::list(body, "messages")? {
        let role = parts::role(message)?;
        let text = content(message.get("content").unwrap_or(&Value::Null), &mut heard.pictures)?;
        heard.messages.push((role, text));
    }
    parts::sampling(&mut heard, body, &["max_completion_tokens", "max_tokens"]);
    Ok(heard)
}

fn content(content: &Value, pictures: &mut Vec<Vec<u8>>) -> Result<String, &'static str> {
    let parts = match content {
        Value::String(text) => return Ok(text.clone()),
        Value::Array(parts) => parts,
        _ => return Err("A message has no content."),
    };
    let mut texts = Vec::new();
    for part in parts {
        match part.get("type").and_then(Value::as_str) {
            Some("text") => texts.push(parts::text(part, "text")?),
            Some("image_url") => {
                let url = part.get("image_url").and_then(|image| image.get("url")?.as_str());
                let data = url.and_then(|url| url.strip_prefix("data:image/")?.split_once(";base64,"));
                let (_, base64) = data.ok_or("Only data URLs of images are read.")?;
                pictures.push(parts::picture(base64)?);
            }
            _ => return Err("A part of a message has no type that is known."),
        }
    }
    Ok(texts.join("\n"))
}

pub(super) fn answer(said: &Said) -> Value {
    let message = match said.end {
        End::Stop if !said.calls.is_empty() => {
            let call = |(at, (name, arguments)): (usize, &(String, Value))| {
                // The arguments are JSON within a text.
                let function = json!({ "name": name, "arguments": arguments.to_string() });
                json!({ "id": format!("call_{at}"), "type": "function", "function": function })
            };
            let calls: Vec<Value> = said.calls.iter().enumerate().map(call).collect();
            json!({ "role": "assistant", "content": said.text, "refusal": null, "tool_calls": calls })
        }
        End::Stop | End::Length => json!({ "role": "assistant", "content": said.text, "refusal": null }),
        End::Filtered => json!({ "role": "assistant", "content": "", "refusal": null }),
        End::Refused => json!({ "role": "assistant", "content": null, "refusal": super::SORRY }),
    };
    let choice = json!({ "index": 0, "message": message, "logprobs": null, "finish_reason": finish(said.end) });
    envelope(said, "chat.completion", &choice)
}

pub(super) fn finish(end: End) -> &'static str {
    match end {
        End::Stop | End::Refused => "stop",
        End::Length => "length",
        End::Filtered => "content_filter",
    }
}

/// A choice within a whole reply.
pub(super) fn envelope(said: &Said, object: &str, choice: &Value) -> Value {
    json!({
        "id": "chatcmpl-test", "object": object, "created": 1_767_225_600, "model": said.model,
        "choices": [choice],
        "usage": {
            "prompt_tokens": said.tokens_in, "completion_tokens": said.tokens_out,
            "total_tokens": said.tokens_in + said.tokens_out,
        },
    })
}

pub(super) fn no_choices() -> Value {
    json!({ "id": "chatcmpl-test", "object": "chat.completion", "choices": [] })
}

pub(super) fn models(names: &[&str]) -> Value {
    let model = |name: &&str| json!({ "id": name, "object": "model", "created": 1_767_225_600, "owned_by": "test" });
    json!({ "object": "list", "data": names.iter().map(model).collect::<Vec<_>>() })
}

pub(super) fn error(wrong: Wrong, message: &str, details: Option<Value>) -> Value {
    let (kind, code) = match wrong {
        Wrong::Request => ("invalid_request_error", Value::Null),
        Wrong::Key => ("invalid_request_error", "invalid_api_key".into()),
        Wrong::Model => ("invalid_request_error", "model_not_found".into()),
        Wrong::Quota => ("insufficient_quota", "insufficient_quota".into()),
        Wrong::TooMany => ("requests", "rate_limit_exceeded".into()),
        Wrong::Server | Wrong::Unavailable | Wrong::Overloaded => ("server_error", Value::Null),
    };
    let mut error = json!({ "message": message, "type": kind, "param": null, "code": code });
    if let (Some(details), Some(error)) = (details, error.as_object_mut()) {
        error.insert("details".to_owned(), details);
    }
    json!({ "error": error })
}

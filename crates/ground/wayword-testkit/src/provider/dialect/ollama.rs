//! The dialect of Ollama's own chat endpoint.

use super::{ReplyEnding, ScriptReply, request_parts};
use crate::provider::ScriptRequest;
use serde_json::{Value, json};

pub(super) fn read_request(body: &Value) -> Result<ScriptRequest, &'static str> {
    if body.get("stream") != Some(&Value::Bool(false)) {
        return Err("Only whole answers are given here: set stream to false.");
    }
    let mut request = ScriptRequest { model: request_parts::text_field(body, "model")?, ..ScriptRequest::default() };
    for message in request_parts::list_field(body, "messages")? {
        request.messages.push((request_parts::message_role(message)?, request_parts::text_field(message, "content")?));
        for image in message.get("images").and_then(Value::as_array).into_iter().flatten() {
            request.pictures.push(request_parts::decode_picture(image.as_str().ok_or("An image is not a text.")?)?);
        }
    }
    request_parts::read_sampling(&mut request, body.get("options").unwrap_or(&Value::Null), &["num_predict"]);
    Ok(request)
}

pub(super) fn reply_body(reply: &ScriptReply) -> Value {
    // Ollama has no filter and no field for refusals: a model refuses in its text.
    let (text, reason) = match reply.end {
        ReplyEnding::Stop => (reply.text.as_str(), "stop"),
        ReplyEnding::Length => (reply.text.as_str(), "length"),
        ReplyEnding::Filtered | ReplyEnding::Refused => (super::REFUSAL_TEXT, "stop"),
    };
    let mut message = json!({ "role": "assistant", "content": text });
    if !reply.calls.is_empty() {
        let call =
            |(name, arguments): &(String, Value)| json!({ "function": { "name": name, "arguments": arguments } });
        message["tool_calls"] = reply.calls.iter().map(call).collect();
    }
    json!({
        "model": reply.model, "created_at": "2026-01-01T00:00:00Z", "message": message,
        "done": true, "done_reason": reason, "total_duration": 1_000_000, "load_duration": 0,
        "prompt_eval_count": reply.tokens_in, "prompt_eval_duration": 0, "eval_count": reply.tokens_out, "eval_duration": 0,
    })
}

pub(super) fn no_choices() -> Value {
    json!({ "model": "", "created_at": "2026-01-01T00:00:00Z", "done": true })
}

pub(super) fn model_list(names: &[&str]) -> Value {
    let model = |name: &&str| json!({ "name": name, "model": name });
    json!({ "models": names.iter().map(model).collect::<Vec<_>>() })
}

pub(super) fn error_body(message: &str) -> Value {
    json!({ "error": message })
}

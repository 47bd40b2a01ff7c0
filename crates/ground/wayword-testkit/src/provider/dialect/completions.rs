//! The dialect of OpenAI's legacy completions: the request has one prompt, and the model continues it.

use super::{ReplyEnding, ScriptReply, openai, request_parts};
use crate::provider::ScriptRequest;
use serde_json::{Value, json};
use wayword_core::MessageRole;

pub(super) fn read_request(body: &Value) -> Result<ScriptRequest, &'static str> {
    let prompt = request_parts::text_field(body, "prompt")?;
    let mut request = ScriptRequest {
        model: request_parts::text_field(body, "model")?,
        messages: vec![(MessageRole::User, prompt)],
        ..ScriptRequest::default()
    };
    request_parts::read_sampling(&mut request, body, &["max_tokens"]);
    Ok(request)
}

pub(super) fn reply_body(reply: &ScriptReply) -> Value {
    let text = match reply.end {
        ReplyEnding::Stop | ReplyEnding::Length => reply.text.as_str(),
        ReplyEnding::Filtered => "",
        ReplyEnding::Refused => super::REFUSAL_TEXT,
    };
    let choice =
        json!({ "index": 0, "text": text, "logprobs": null, "finish_reason": openai::finish_reason(reply.end) });
    openai::wrap_choice(reply, "text_completion", &choice)
}

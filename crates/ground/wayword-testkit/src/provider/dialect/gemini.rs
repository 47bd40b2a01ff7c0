//! The dialect of Gemini's `generateContent`.

use super::{ReplyEnding, ScriptReply, ServiceErrorKind, request_parts};
use crate::provider::ScriptRequest;
use serde_json::{Value, json};
use wayword_core::MessageRole;

pub(super) fn read_request(body: &Value, model: &str) -> Result<ScriptRequest, &'static str> {
    let mut request = ScriptRequest { model: model.to_owned(), ..ScriptRequest::default() };
    if let Some(system) = body.get("systemInstruction").or_else(|| body.get("system_instruction")) {
        let text = read_content(system, &mut request.pictures)?;
        request.messages.push((MessageRole::System, text));
    }
    for message in request_parts::list_field(body, "contents")? {
        // A single content may lack its role.
        let role =
            if message.get("role").is_some() { request_parts::message_role(message)? } else { MessageRole::User };
        let text = read_content(message, &mut request.pictures)?;
        request.messages.push((role, text));
    }
    request_parts::read_sampling(
        &mut request,
        body.get("generationConfig").unwrap_or(&Value::Null),
        &["maxOutputTokens"],
    );
    Ok(request)
}

/// The text of a content, the parts joined by line ends. Its pictures are added to `pictures`.
fn read_content(content: &Value, pictures: &mut Vec<Vec<u8>>) -> Result<String, &'static str> {
    let mut texts = Vec::new();
    for part in request_parts::list_field(content, "parts")? {
        match part.get("inlineData").or_else(|| part.get("inline_data")) {
            Some(picture) => {
                pictures.push(request_parts::decode_picture(&request_parts::text_field(picture, "data")?)?);
            }
            None => texts.push(request_parts::text_field(part, "text")?),
        }
    }
    Ok(texts.join("\n"))
}

pub(super) fn reply_body(reply: &ScriptReply) -> Value {
    let call = |(name, args): &(String, Value)| json!({ "functionCall": { "name": name, "args": args } });
    let words = [json!({ "text": reply.text })];
    let parts: Vec<Value> = words.into_iter().chain(reply.calls.iter().map(call)).collect();
    let content = json!({ "role": "model", "parts": parts });
    let candidate = match reply.end {
        ReplyEnding::Stop => json!({ "content": content, "finishReason": "STOP", "index": 0 }),
        ReplyEnding::Length => json!({ "content": content, "finishReason": "MAX_TOKENS", "index": 0 }),
        ReplyEnding::Filtered => json!({ "finishReason": "SAFETY", "index": 0 }),
        ReplyEnding::Refused => json!({ "finishReason": "PROHIBITED_CONTENT", "index": 0 }),
    };
    json!({
        "candidates": [candidate],
        "usageMetadata": {
            "promptTokenCount": reply.tokens_in, "candidatesTokenCount": reply.tokens_out,
            "totalTokenCount": reply.tokens_in + reply.tokens_out,
        },
        "modelVersion": reply.model,
    })
}

pub(super) fn no_choices() -> Value {
    json!({ "candidates": [] })
}

pub(super) fn model_list(names: &[&str]) -> Value {
    let model = |name: &&str| json!({ "name": format!("models/{name}"), "displayName": name, "supportedGenerationMethods": ["generateContent"] });
    json!({ "models": names.iter().map(model).collect::<Vec<_>>() })
}

pub(super) fn error_body(kind: ServiceErrorKind, message: &str, details: Option<Value>, code: u16) -> Value {
    let status = match kind {
        ServiceErrorKind::Request => "INVALID_ARGUMENT",
        ServiceErrorKind::Key => "UNAUTHENTICATED",
        ServiceErrorKind::Model => "NOT_FOUND",
        ServiceErrorKind::Quota | ServiceErrorKind::TooMany => "RESOURCE_EXHAUSTED",
        ServiceErrorKind::Server => "INTERNAL",
        ServiceErrorKind::Unavailable | ServiceErrorKind::Overloaded => "UNAVAILABLE",
    };
    let details = if kind == ServiceErrorKind::Quota { Some(daily_quota_details()) } else { details };
    let mut error = json!({ "code": code, "message": message, "status": status });
    if let (Some(details), Some(error)) = (details, error.as_object_mut()) {
        error.insert("details".to_owned(), details);
    }
    json!({ "error": error })
}

/// The details of a used-up quota. Only the quota's name distinguishes it from a rate.
fn daily_quota_details() -> Value {
    let violation = json!({ "quotaId": "GenerateRequestsPerDayPerProjectPerModel-FreeTier", "quotaValue": "250" });
    json!([{ "@type": "type.googleapis.com/google.rpc.QuotaFailure", "violations": [violation] }])
}

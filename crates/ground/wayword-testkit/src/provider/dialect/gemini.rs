//! The dialect of Gemini's `generateContent`.

use super::{End, Said, Wrong, parts};
use crate::provider::Heard;
use serde_json::{Value, json};
use wayword_core::Role;

pub(super) fn heard(body: &Value, model: &str) -> Result<Heard, &'static str> {
    let mut heard = Heard { model: model.to_owned(), ..Heard::default() };
    if let Some(system) = body.get("systemInstruction").or_else(|| body.get("system_instruction")) {
        let text = content(system, &mut heard.pictures)?;
        heard.messages.push((Role::System, text));
    }
    for message in parts::list(body, "contents")? {
        // A single content may lack its role.
        let role = if message.get("role").is_some() { parts::role(message)? } else { Role::User };
        let text = content(message, &mut heard.pictures)?;
        heard.messages.push((role, text));
    }
    parts::sampling(&mut heard, body.get("generationConfig").unwrap_or(&Value::Null), &["maxOutputTokens"]);
    Ok(heard)
}

fn content(content: &Value, pictures: &mut Vec<Vec<u8>>) -> Result<String, &'static str> {
    let mut texts = Vec::new();
    for part in parts::list(content, "parts")? {
        match part.get("inlineData").or_else(|| part.get("inline_data")) {
            Some(picture) => pictures.push(parts::picture(&parts::text(picture, "data")?)?),
            None => texts.push(parts::text(part, "text")?),
        }
    }
    Ok(texts.join("\n"))
}

pub(super) fn answer(said: &Said) -> Value {
    let call = |(name, args): &(String, Value)| json!({ "functionCall": { "name": name, "args": args } });
    let words = [json!({ "text": said.text })];
    let parts: Vec<Value> = words.into_iter().chain(said.calls.iter().map(call)).collect();
    let content = json!({ "role": "model", "parts": parts });
    let candidate = match said.end {
        End::Stop => json!({ "content": content, "finishReason": "STOP", "index": 0 }),
        End::Length => json!({ "content": content, "finishReason": "MAX_TOKENS", "index": 0 }),
        End::Filtered => json!({ "finishReason": "SAFETY", "index": 0 }),
        End::Refused => json!({ "finishReason": "PROHIBITED_CONTENT", "index": 0 }),
    };
    json!({
        "candidates": [candidate],
        "usageMetadata": {
            "promptTokenCount": said.tokens_in, "candidatesTokenCount": said.tokens_out,
            "totalTokenCount": said.tokens_in + said.tokens_out,
        },
        "modelVersion": said.model,
    })
}

pub(super) fn no_choices() -> Value {
    json!({ "candidates": [] })
}

pub(super) fn models(names: &[&str]) -> Value {
    let model = |name: &&str| json!({ "name": format!("models/{name}"), "displayName": name, "supportedGenerationMethods": ["generateContent"] });
    json!({ "models": names.iter().map(model).collect::<Vec<_>>() })
}

pub(super) fn error(wrong: Wrong, message: &str, details: Option<Value>, code: u16) -> Value {
    let status = match wrong {
        Wrong::Request => "INVALID_ARGUMENT",
        Wrong::Key => "UNAUTHENTICATED",
        Wrong::Model => "NOT_FOUND",
        Wrong::Quota | Wrong::TooMany => "RESOURCE_EXHAUSTED",
        Wrong::Server => "INTERNAL",
        Wrong::Unavailable | Wrong::Overloaded => "UNAVAILABLE",
    };
    let details = if wrong == Wrong::Quota { Some(day_is_over()) } else { details };
    let mut error = json!({ "code": code, "message": message, "status": status });
    if let (Some(details), Some(error)) = (details, error.as_object_mut()) {
        error.insert("details".to_owned(), details);
    }
    json!({ "error": error })
}

/// The details of a used-up quota. Only the quota's name distinguishes it from a rate.
fn day_is_over() -> Value {
    let violation = json!({ "quotaId": "GenerateRequestsPerDayPerProjectPerModel-FreeTier", "quotaValue": "250" });
    json!([{ "@type": "type.googleapis.com/google.rpc.QuotaFailure", "violations": [violation] }])
}

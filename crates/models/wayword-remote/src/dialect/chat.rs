//! OpenAI's chat completions (<https://platform.openai.com/docs/api-reference/chat>).

use super::{
    DialectReply, DialectRequest, MissingField, RemoteMessage, ReplyEnd, WireRequest, content_text, seed_of_31_bits,
    tool_call_line,
};
use crate::JsonMode;
use serde_json::{Map, Value, json};
use wayword_core::{MessageRole, ModelTool};

/// Turns a request into a body for this API.
pub(super) fn to_wire(request: DialectRequest<'_>) -> WireRequest {
    let mut body = Map::new();
    body.insert("model".to_owned(), request.model.into());
    body.insert("messages".to_owned(), request.lines.iter().map(message_json).collect());
    insert_sampling(request, &mut body);
    if let Some((way, name, schema)) = request.json_form() {
        let format = match way {
            JsonMode::Schema => {
                json!({ "type": "json_schema", "json_schema": { "name": name, "strict": true, "schema": schema } })
            }
            JsonMode::Object | JsonMode::Prompt => json!({ "type": "json_object" }),
        };
        body.insert("response_format".to_owned(), format);
    }
    let tools = tools_json(request);
    if !tools.is_empty() {
        body.insert("tools".to_owned(), tools.into());
        body.insert("tool_choice".to_owned(), "required".into());
    }
    WireRequest { path: "/chat/completions".to_owned(), body: body.into() }
}

/// The tools, in the form that this dialect and Ollama's share.
pub(super) fn tools_json(request: DialectRequest<'_>) -> Vec<Value> {
    let tool = |(tool, arguments): (&'static ModelTool, Value)| {
        let function = json!({ "name": tool.name, "description": tool.does, "parameters": arguments });
        json!({ "type": "function", "function": function })
    };
    request.callable_tools().into_iter().map(tool).collect()
}

/// The tools that a reply calls, each as a line.
pub(super) fn tool_calls(body: &Value) -> Vec<String> {
    let message = body.get("choices").and_then(|choices| choices.get(0)?.get("message"));
    message.map(message_tool_calls).unwrap_or_default()
}

/// The tools that a message calls, each as a line, in the form that this dialect and Ollama's share.
pub(super) fn message_tool_calls(message: &Value) -> Vec<String> {
    // Some gateways give one call, calls by their number, or the field of older versions.
    let calls: Vec<&Value> = match message.get("tool_calls") {
        Some(Value::Array(calls)) => calls.iter().collect(),
        Some(Value::Object(call)) if call.contains_key("function") => message.get("tool_calls").into_iter().collect(),
        Some(Value::Object(calls)) => calls.values().collect(),
        _ => Vec::new(),
    };
    let function = |call: &Value| {
        let function = call.get("function").unwrap_or(call);
        tool_call_line(function.get("name"), function.get("arguments").or_else(|| function.get("parameters")))
    };
    let calls: Vec<String> = calls.into_iter().filter_map(function).collect();
    let older = || message.get("function_call").and_then(function).into_iter().collect();
    if calls.is_empty() { older() } else { calls }
}

/// The sampling fields that this dialect and the completions share.
pub(super) fn insert_sampling(request: DialectRequest<'_>, body: &mut Map<String, Value>) {
    let (provider, sampling) = (request.provider, request.sampling);
    if provider.sends_field("temperature") {
        body.insert("temperature".to_owned(), sampling.temperature.into());
    }
    if provider.sends_field("max_tokens") {
        body.insert(provider.max_tokens_field.clone(), sampling.max_tokens.into());
    }
    if provider.sends_field("seed") {
        body.insert(provider.seed_field.clone(), seed_of_31_bits(sampling).into());
    }
}

/// A message in the form of this API.
fn message_json(line: &RemoteMessage) -> Value {
    let role = match line.role {
        MessageRole::System => "system",
        MessageRole::User => "user",
        MessageRole::Assistant => "assistant",
    };
    if line.pictures.is_empty() {
        return json!({ "role": role, "content": line.text });
    }
    let mut parts = vec![json!({ "type": "text", "text": line.text })];
    parts.extend(line.pictures.iter().map(|picture| {
        let url = format!("data:image/jpeg;base64,{}", picture.base64);
        json!({ "type": "image_url", "image_url": { "url": url } })
    }));
    json!({ "role": role, "content": parts })
}

/// Reads a reply's body.
pub(super) fn from_wire(body: &Value) -> Result<DialectReply, MissingField> {
    let choice = body.get("choices").and_then(|choices| choices.get(0)).ok_or(MissingField("choices"))?;
    let message = choice.get("message").ok_or(MissingField("message"))?;
    let refusal = message.get("refusal").and_then(Value::as_str).filter(|why| !why.is_empty());
    let end = refusal.map_or_else(|| reply_end(choice), |why| Ok(ReplyEnd::Refused(why.to_owned())))?;
    let text = message.get("content").map(content_text).unwrap_or_default();
    let has_thoughts = ["reasoning_content", "reasoning"]
        .iter()
        .any(|field| message.get(*field).and_then(Value::as_str).is_some_and(|text| !text.trim().is_empty()));
    let end = if end == ReplyEnd::Stop && text.trim().is_empty() && has_thoughts { ReplyEnd::Thought } else { end };
    Ok(with_usage(body, text, end))
}

/// Why a choice ended. If an error ended it, which OpenRouter reports here, it has no end: the text until then is not
/// an answer.
pub(super) fn reply_end(choice: &Value) -> Result<ReplyEnd, MissingField> {
    if choice.get("error").is_some_and(|error| !error.is_null()) {
        return Err(MissingField("end"));
    }
    match choice.get("finish_reason").and_then(Value::as_str) {
        Some("error") => Err(MissingField("end")),
        Some("length") => Ok(ReplyEnd::Length),
        Some("content_filter") => Ok(ReplyEnd::Filtered("content_filter".to_owned())),
        _ => Ok(ReplyEnd::Stop),
    }
}

/// A reply with its token counts. Thinking is paid for too. Most services count it in the tokens of the completion, but
/// xAI counts it in the total alone.
pub(super) fn with_usage(body: &Value, text: String, end: ReplyEnd) -> DialectReply {
    let tokens = |field: &str| body.get("usage")?.get(field)?.as_u64();
    let tokens_in = tokens("prompt_tokens");
    let tokens_after_prompt = tokens("total_tokens").zip(tokens_in).map(|(total, prompt)| total.saturating_sub(prompt));
    DialectReply { text, end, tokens_in, tokens_out: tokens("completion_tokens").max(tokens_after_prompt) }
}

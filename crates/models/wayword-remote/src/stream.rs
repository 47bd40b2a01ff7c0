//! Joins the pieces of a reply that a service streams although no stream was asked for, so that it is read like any other.

use serde_json::{Map, Value, json};

/// Most events of a stream that are read.
const MAX_EVENTS: usize = 100_000;

/// The reply that a body streams, in the form that it would have had in one piece: events ("data: ...") of OpenAI's
/// dialects, of Anthropic's and of Gemini's, or lines of Ollama's. An event that reports an error is returned as it is. `None` where the body is no
/// stream, or the stream breaks off.
pub(crate) fn joined_stream(text: &str) -> Option<Value> {
    let events: Vec<Value> = text.lines().take(MAX_EVENTS).filter_map(event_json).collect();
    let is_stream = events.len() > 1 || text.trim_start().starts_with("data:");
    if !is_stream {
        return None;
    }
    if let Some(error) = events.iter().find(|event| event.get("error").is_some_and(|error| !error.is_null())) {
        return Some(error.clone());
    }
    let is_done =
        text.lines().any(|line| line.trim().strip_prefix("data:").is_some_and(|data| data.trim() == "[DONE]"));
    joined_lines(&events)
        .or_else(|| joined_blocks(&events))
        .or_else(|| joined_candidates(&events))
        .or_else(|| joined_choices(&events, is_done))
}

/// The JSON of a line: all of it, or what stands behind "data:".
fn event_json(line: &str) -> Option<Value> {
    let line = line.trim();
    let data = line.strip_prefix("data:").map_or(line, str::trim_start);
    if data.starts_with('{') { serde_json::from_str(data).ok() } else { None }
}

/// Ollama's lines: pieces of the message, the last with the reason for the end and the counts.
fn joined_lines(events: &[Value]) -> Option<Value> {
    let last = events.last().filter(|event| event.get("done").and_then(Value::as_bool) == Some(true))?;
    let piece = |event: &Value| Some(event.get("message")?.get("content")?.as_str()?.to_owned());
    let mut whole = last.clone();
    let calls = events.iter().find_map(|event| event.get("message")?.get("tool_calls").cloned());
    whole["message"] = json!({ "role": "assistant", "content": events.iter().filter_map(piece).collect::<String>() });
    if let Some(calls) = calls {
        whole["message"]["tool_calls"] = calls;
    }
    Some(whole)
}

/// Anthropic's events: pieces of the text, and the reason for the end. A stream with a call of a tool is not joined.
fn joined_blocks(events: &[Value]) -> Option<Value> {
    let kind = |event: &Value| event.get("type").and_then(Value::as_str).unwrap_or_default().to_owned();
    events.iter().find(|event| kind(event) == "message_stop")?;
    if events.iter().any(|event| event.get("delta").is_some_and(|delta| delta.get("partial_json").is_some())) {
        return None;
    }
    let text: String = events.iter().filter_map(|event| event.get("delta")?.get("text")?.as_str()).collect();
    let end = events.iter().rev().find_map(|event| event.get("delta")?.get("stop_reason").cloned());
    let begun = events.iter().find_map(|event| event.get("message")?.get("usage"));
    let ended = events.iter().rev().find_map(|event| event.get("usage"));
    let tokens = |usage: Option<&Value>, field: &str| usage.and_then(|usage| usage.get(field).cloned());
    Some(json!({
        "content": [{ "type": "text", "text": text }],
        "stop_reason": end,
        "usage": { "input_tokens": tokens(begun, "input_tokens"), "output_tokens": tokens(ended, "output_tokens") },
    }))
}

/// Gemini's events: each is a reply with a piece of the text, and the last has the reason for the end and the counts.
fn joined_candidates(events: &[Value]) -> Option<Value> {
    let candidates = || events.iter().filter_map(|event| event.get("candidates")?.get(0));
    let mut whole = events.iter().rev().find(|event| event.get("candidates").is_some())?.clone();
    candidates().find(|candidate| candidate.get("finishReason").is_some())?;
    let parts = candidates().filter_map(|candidate| candidate.get("content")?.get("parts")?.as_array());
    let parts: Vec<Value> = parts.flatten().cloned().collect();
    whole["candidates"][0]["content"] = json!({ "parts": parts });
    Some(whole)
}

/// The chunks of OpenAI's chats and completions. Some servers give no reason for the end, but mark it (`is_done`).
fn joined_choices(events: &[Value], is_done: bool) -> Option<Value> {
    let choices = || events.iter().filter_map(|event| event.get("choices")?.get(0));
    let end = choices().filter_map(|choice| choice.get("finish_reason")).rfind(|end| !end.is_null());
    let end = end.cloned().or_else(|| (is_done && choices().next().is_some()).then(|| "stop".into()))?;
    let mut choice = Map::new();
    choice.insert("finish_reason".to_owned(), end);
    if choices().any(|choice| choice.get("text").is_some()) {
        let text: String = choices().filter_map(|choice| choice.get("text")?.as_str()).collect();
        choice.insert("text".to_owned(), text.into());
    }
    let deltas = || choices().filter_map(|choice| choice.get("delta").or_else(|| choice.get("message")));
    let joined = |field: &str| deltas().filter_map(|delta| delta.get(field)?.as_str()).collect::<String>();
    let mut message = Map::new();
    for field in ["content", "refusal", "reasoning_content"] {
        message.insert(field.to_owned(), joined(field).into());
    }
    message.insert("tool_calls".to_owned(), joined_calls(deltas().filter_map(|delta| delta.get("tool_calls"))).into());
    choice.insert("message".to_owned(), message.into());
    let usage = events.iter().rev().find_map(|event| event.get("usage").filter(|usage| !usage.is_null()));
    Some(json!({ "choices": [choice], "usage": usage.cloned().unwrap_or_default() }))
}

/// The calls of tools, whose arguments come in pieces.
fn joined_calls<'a>(pieces: impl Iterator<Item = &'a Value>) -> Vec<Value> {
    let mut calls: Vec<(String, String)> = Vec::new();
    for piece in pieces.filter_map(Value::as_array).flatten() {
        let Some(function) = piece.get("function") else { continue };
        let text = |field: &str| function.get(field).and_then(Value::as_str).unwrap_or_default();
        let at = piece.get("index").and_then(Value::as_u64).and_then(|at| usize::try_from(at).ok());
        match at.filter(|at| *at < calls.len()) {
            Some(at) => {
                calls[at].0.push_str(text("name"));
                calls[at].1.push_str(text("arguments"));
            }
            None => calls.push((text("name").to_owned(), text("arguments").to_owned())),
        }
    }
    let call = |(name, arguments)| json!({ "function": { "name": name, "arguments": arguments } });
    calls.into_iter().map(call).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ServiceDialect, dialect::ReplyEnd};

    #[test]
    fn a_stream_is_read_like_a_reply_in_one_piece() {
        let chat = concat!(
            ": keep-alive\n\n",
            "data: {\"choices\":[{\"delta\":{\"role\":\"assistant\",\"content\":\"A \"}}]}\n\n",
            "data:{\"choices\":[{\"delta\":{\"content\":\"sofa.\"},\"finish_reason\":null}]}\n\n",
            "data: {\"choices\":[{\"delta\":{},\"finish_reason\":\"length\"}],\"usage\":{\"prompt_tokens\":7}}\n\n",
            "data: [DONE]\n\n",
        );
        let lines = concat!(
            "{\"message\":{\"content\":\"A \"},\"done\":false}\n",
            "{\"message\":{\"content\":\"sofa.\"},\"done\":true,\"done_reason\":\"length\",\"prompt_eval_count\":7}\n",
        );
        let unended = "data: {\"choices\":[{\"delta\":{\"content\":\"A sofa.\"}}],\"usage\":{\"prompt_tokens\":7}}\r\n\r\ndata: [DONE]\r\n";
        assert_eq!(joined_stream(unended).unwrap()["choices"][0]["message"]["content"], "A sofa.");
        let blocks = concat!(
            "event: message_start\ndata: {\"type\":\"message_start\",\"message\":{\"usage\":{\"input_tokens\":7}}}\n\n",
            "data: {\"type\":\"content_block_delta\",\"delta\":{\"type\":\"text_delta\",\"text\":\"A \"}}\n\n",
            "data: {\"type\":\"content_block_delta\",\"delta\":{\"type\":\"text_delta\",\"text\":\"sofa.\"}}\n\n",
            "data: {\"type\":\"message_delta\",\"delta\":{\"stop_reason\":\"max_tokens\"},\"usage\":{\"output_tokens\":3}}\n\n",
            "data: {\"type\":\"message_stop\"}\n\n",
        );
        let candidates = concat!(
            "data: {\"candidates\":[{\"content\":{\"parts\":[{\"text\":\"A \"}]}}]}\n\n",
            "data: {\"candidates\":[{\"content\":{\"parts\":[{\"text\":\"sofa.\"}]},\"finishReason\":\"MAX_TOKENS\"}],\"usageMetadata\":{\"promptTokenCount\":7}}\n\n",
        );
        let text = "data: {\"choices\":[{\"text\":\"A sofa.\",\"finish_reason\":\"length\"}],\"usage\":{\"prompt_tokens\":7}}\n";
        for (dialect, body) in [
            (ServiceDialect::OpenAi, chat),
            (ServiceDialect::Ollama, lines),
            (ServiceDialect::Completions, text),
            (ServiceDialect::Anthropic, blocks),
            (ServiceDialect::Gemini, candidates),
        ] {
            let reply = dialect.read_reply(&joined_stream(body).unwrap()).unwrap();
            assert_eq!((reply.text.as_str(), reply.end, reply.tokens_in), ("A sofa.", ReplyEnd::Length, Some(7)));
        }
    }

    #[test]
    fn a_call_of_a_tool_comes_in_pieces() {
        let body = concat!(
            "data: {\"choices\":[{\"delta\":{\"tool_calls\":[{\"index\":0,\"function\":{\"name\":\"step\",\"arguments\":\"{\\\"wa\"}}]}}]}\n",
            "data: {\"choices\":[{\"delta\":{\"tool_calls\":[{\"index\":0,\"function\":{\"arguments\":\"y\\\": 2}\"}}]},\"finish_reason\":\"tool_calls\"}]}\n",
        );
        let reply = ServiceDialect::OpenAi.read_reply(&joined_stream(body).unwrap()).unwrap();
        assert_eq!(reply.text, "step {\"way\":2}");
    }

    #[test]
    fn what_is_no_whole_stream_is_not_joined() {
        for body in [
            "",
            "data: [DONE]",
            "<html>",
            "{\"choices\":[]}",
            "data: {\"choices\":[{\"delta\":{\"content\":\"A\"}}]}\n",
        ] {
            assert_eq!(joined_stream(body), None, "{body}");
        }
        let error = "data: {\"choices\":[]}\ndata: {\"error\":{\"message\":\"overloaded\"}}\n";
        assert_eq!(joined_stream(error).unwrap()["error"]["message"], "overloaded");
    }
}

use super::*;
use crate::{RemoteConfig, provider::ProviderTable};
use serde_json::json;

fn provider(name: &str, own: &str) -> RemoteProvider {
    let mut config: RemoteConfig = toml::from_str(own).unwrap();
    if ["server", "completions"].contains(&name) {
        config.base_url = Some("http://127.0.0.1:1/v1".to_owned());
    }
    ProviderTable::new(&config.providers).resolve_provider(name, &config).unwrap()
}

fn line(role: MessageRole, text: &str) -> RemoteMessage {
    RemoteMessage { role, text: text.to_owned(), pictures: Vec::new() }
}

fn seen(text: &str) -> RemoteMessage {
    let picture = EncodedPicture { base64: "QUJD".to_owned(), sha256: "00".to_owned() };
    RemoteMessage { pictures: vec![Arc::new(picture)], ..line(MessageRole::User, text) }
}

fn conversation() -> Vec<RemoteMessage> {
    vec![
        line(MessageRole::System, "Be brief."),
        line(MessageRole::User, "Hi."),
        line(MessageRole::Assistant, "Yes?"),
        seen("What is this?"),
    ]
}

fn wire(provider: &RemoteProvider, lines: &[RemoteMessage]) -> Result<WireRequest, &'static str> {
    let sampling = SamplingOptions { temperature: 0.5, max_tokens: 30, seed: u64::MAX };
    provider.dialect.to_wire(DialectRequest {
        provider,
        model: "m/1",
        lines,
        sampling: &sampling,
        schema: None,
        tools: &[],
        context_tokens: 0,
    })
}

const SCHEMA: ReplySchema = ReplySchema {
    name: "view",
    json: r#"{"type": "object", "additionalProperties": false, "properties": {"type": {"type": "string"}}}"#,
};

/// The body of a request for a reply in JSON.
fn body_for_json(provider: &RemoteProvider) -> Value {
    let sampling = SamplingOptions { temperature: 0.0, max_tokens: 30, seed: 0 };
    let lines = [line(MessageRole::User, "Hi.")];
    let asked = DialectRequest {
        provider,
        model: "m",
        lines: &lines,
        sampling: &sampling,
        schema: Some(SCHEMA),
        tools: &[],
        context_tokens: 0,
    };
    provider.dialect.to_wire(asked).unwrap().body
}

#[test]
fn to_wire_sends_the_schema_to_services_that_enforce_it() {
    let schema: Value = serde_json::from_str(SCHEMA.json).unwrap();
    let strict = json!({ "type": "json_schema", "json_schema": { "name": "view", "strict": true, "schema": schema } });
    assert_eq!(body_for_json(&provider("openai", ""))["response_format"], strict);
    assert_eq!(body_for_json(&provider("ollama", ""))["format"], schema);
    assert_eq!(body_for_json(&provider("deepseek", ""))["response_format"], json!({ "type": "json_object" }));
    let gemini = &body_for_json(&provider("gemini", ""))["generationConfig"];
    assert_eq!(gemini["responseMimeType"], "application/json");
    let wanted = json!({ "type": "OBJECT", "properties": { "type": { "type": "STRING" } } });
    assert_eq!(gemini["responseSchema"], wanted);
}

#[test]
fn to_wire_sends_no_schema_to_other_services() {
    for body in [
        body_for_json(&provider("server", "")),
        body_for_json(&provider("anthropic", "")),
        body_for_json(&provider("openai", "[providers.openai]\njson = \"prompt\"")),
    ] {
        assert!(body.get("response_format").is_none() && body.get("format").is_none(), "{body}");
    }
    let strict = body_for_json(&provider("server", "[providers.server]\njson = \"schema\""));
    assert_eq!(strict["response_format"]["type"], "json_schema");
}

const TOOLS: &[ModelTool] = &[ModelTool {
    name: "step",
    does: "walks",
    arguments: r#"{"type": "object", "properties": {"way": {"type": "integer"}}}"#,
}];

/// The body of a request to a model that may call a tool.
fn body_with_tools(provider: &RemoteProvider) -> Value {
    let sampling = SamplingOptions { temperature: 0.0, max_tokens: 30, seed: 0 };
    let lines = [line(MessageRole::User, "Hi.")];
    let asked = DialectRequest {
        provider,
        model: "m",
        lines: &lines,
        sampling: &sampling,
        schema: None,
        tools: TOOLS,
        context_tokens: 0,
    };
    provider.dialect.to_wire(asked).unwrap().body
}

#[test]
fn to_wire_describes_tools_in_each_dialect() {
    let arguments = json!({ "type": "object", "properties": { "way": { "type": "integer" } } });
    let function = json!({ "name": "step", "description": "walks", "parameters": arguments });
    let openai = body_with_tools(&provider("openai", ""));
    assert_eq!(openai["tools"], json!([{ "type": "function", "function": function }]));
    assert_eq!(openai["tool_choice"], "required");
    let anthropic = body_with_tools(&provider("anthropic", ""));
    assert_eq!(anthropic["tools"], json!([{ "name": "step", "description": "walks", "input_schema": arguments }]));
    assert_eq!(anthropic["tool_choice"], json!({ "type": "any" }));
    let gemini = body_with_tools(&provider("gemini", ""));
    let declared = json!({ "type": "OBJECT", "properties": { "way": { "type": "INTEGER" } } });
    let declared = json!({ "name": "step", "description": "walks", "parameters": declared });
    assert_eq!(gemini["tools"], json!([{ "functionDeclarations": [declared] }]));
    assert_eq!(gemini["toolConfig"]["functionCallingConfig"]["mode"], "ANY");
    let ollama = body_with_tools(&provider("ollama", "[providers.ollama]\ntools = true"));
    assert_eq!(ollama["tools"], openai["tools"]);
    for without in ["ollama", "vllm", "server", "completions"] {
        let body = body_with_tools(&provider(without, ""));
        assert!(body.get("tools").is_none() && body.get("tool_choice").is_none(), "{body}");
    }
}

#[test]
fn heard_appends_tool_calls_as_lines() {
    let heard = |dialect: ServiceDialect, body: Value| dialect.read_reply(&body).unwrap().text;
    let calls = json!([
        { "id": "1", "type": "function", "function": { "name": "step", "arguments": "{\"way\":\n 2}" } },
        { "id": "2", "type": "function", "function": { "name": "observe", "arguments": "not\nJSON" } },
        { "id": "3", "type": "function", "function": { "arguments": "{}" } },
    ]);
    let message = json!({ "role": "assistant", "content": null, "tool_calls": calls });
    let body = json!({ "choices": [{ "message": message, "finish_reason": "tool_calls" }] });
    assert_eq!(heard(ServiceDialect::OpenAi, body), "step {\"way\":2}\nobserve not JSON");
    let body = json!({ "content": [
        { "type": "text", "text": "I turn left." },
        { "type": "tool_use", "id": "1", "name": "step", "input": { "way": 2 } },
    ], "stop_reason": "tool_use" });
    assert_eq!(heard(ServiceDialect::Anthropic, body), "I turn left.\nstep {\"way\":2}");
    let parts = json!([{ "functionCall": { "name": "stop", "args": { "why": "there" } } }]);
    let body = json!({ "candidates": [{ "content": { "parts": parts }, "finishReason": "STOP" }] });
    assert_eq!(heard(ServiceDialect::Gemini, body), "stop {\"why\":\"there\"}");
    let calls = json!([{ "function": { "name": "step", "arguments": { "way": 1 } } }]);
    let message = json!({ "role": "assistant", "content": "<think>hm</think>", "tool_calls": calls });
    assert_eq!(heard(ServiceDialect::Ollama, json!({ "message": message })), "step {\"way\":1}");
}

#[test]
fn openai_takes_pictures_as_data_urls() {
    let wire = wire(&provider("server", ""), &conversation()).unwrap();
    assert_eq!(wire.path, "/chat/completions");
    let expected = json!({
        "model": "m/1",
        "messages": [
            { "role": "system", "content": "Be brief." },
            { "role": "user", "content": "Hi." },
            { "role": "assistant", "content": "Yes?" },
            { "role": "user", "content": [
                { "type": "text", "text": "What is this?" },
                { "type": "image_url", "image_url": { "url": "data:image/jpeg;base64,QUJD" } },
            ] },
        ],
        "temperature": 0.5,
        "max_tokens": 30,
        "seed": 0x7fff_ffff,
    });
    assert_eq!(wire.body, expected);
}

#[test]
fn fields_are_named_left_out_and_added_as_a_provider_wants() {
    let own = "[providers.openai]\nomit = [\"temperature\"]\nextra = { reasoning_effort = \"low\" }";
    let body = wire(&provider("openai", own), &[line(MessageRole::User, "Hi.")]).unwrap().body;
    assert_eq!(body["max_completion_tokens"], 30);
    assert_eq!(body["reasoning_effort"], "low");
    assert!(body.get("max_tokens").is_none() && body.get("temperature").is_none());
    let body = wire(&provider("mistral", ""), &[line(MessageRole::User, "Hi.")]).unwrap().body;
    assert_eq!(body["random_seed"], 0x7fff_ffff);
    assert!(body.get("seed").is_none());
}

#[test]
fn anthropic_takes_the_system_apart_and_pictures_first() {
    let wire = wire(&provider("anthropic", ""), &conversation()).unwrap();
    assert_eq!(wire.path, "/messages");
    let expected = json!({
        "model": "m/1",
        "max_tokens": 30,
        "system": "Be brief.",
        "messages": [
            { "role": "user", "content": "Hi." },
            { "role": "assistant", "content": "Yes?" },
            { "role": "user", "content": [
                { "type": "image", "source": { "type": "base64", "media_type": "image/jpeg", "data": "QUJD" } },
                { "type": "text", "text": "What is this?" },
            ] },
        ],
        "temperature": 0.5,
    });
    assert_eq!(wire.body, expected);
}

#[test]
fn gemini_puts_the_model_only_into_its_path() {
    let wire = wire(&provider("gemini", ""), &conversation()).unwrap();
    assert_eq!(wire.path, "/models/m%2F1:generateContent");
    let expected = json!({
        "systemInstruction": { "parts": [{ "text": "Be brief." }] },
        "contents": [
            { "role": "user", "parts": [{ "text": "Hi." }] },
            { "role": "model", "parts": [{ "text": "Yes?" }] },
            { "role": "user", "parts": [
                { "text": "What is this?" },
                { "inlineData": { "mimeType": "image/jpeg", "data": "QUJD" } },
            ] },
        ],
        "generationConfig": { "temperature": 0.5, "maxOutputTokens": 30, "seed": 0x7fff_ffff },
    });
    assert_eq!(wire.body, expected);
}

#[test]
fn gemini_merges_a_users_tables_with_its_own() {
    let own = "[providers.gemini]\nextra = { generationConfig = { thinkingConfig = { thinkingBudget = 0 } } }";
    let body = wire(&provider("gemini", own), &[line(MessageRole::User, "Hi.")]).unwrap().body;
    assert_eq!(body["generationConfig"]["thinkingConfig"]["thinkingBudget"], 0);
    assert_eq!(body["generationConfig"]["maxOutputTokens"], 30);
}

#[test]
fn ollama_does_not_think_unless_the_settings_ask_for_it() {
    let wire_of = |own: &str| wire(&provider("ollama", own), &conversation()).unwrap();
    let wire = wire_of("");
    assert_eq!(wire.path, "/api/chat");
    let expected = json!({
        "model": "m/1",
        "messages": [
            { "role": "system", "content": "Be brief." },
            { "role": "user", "content": "Hi." },
            { "role": "assistant", "content": "Yes?" },
            { "role": "user", "content": "What is this?", "images": ["QUJD"] },
        ],
        "stream": false,
        "options": { "temperature": 0.5, "num_predict": 30, "seed": 0x7fff_ffff, "num_ctx": 8192 },
        "think": false,
    });
    assert_eq!(wire.body, expected);
    let own = "[providers.ollama]\nextra = { think = true, options = { num_ctx = 3000 } }";
    let body = wire_of(own).body;
    assert_eq!(body["think"], true);
    assert_eq!(body["options"]["num_ctx"], 3000);
    assert_eq!(body["options"]["num_predict"], 30);
    assert_eq!(wire_of("[providers.ollama]\ncontext_tokens = 4096").body["options"]["num_ctx"], 4096);
}

/// A long prompt gets a longer context, in few sizes, because Ollama loads the model again for each.
#[test]
fn ollama_is_asked_for_the_context_that_the_prompt_needs() {
    let size = |context_tokens| ollama::context_size(context_tokens);
    assert_eq!([size(0), size(8_192), size(8_193), size(20_000)], [8_192, 8_192, 16_384, 32_768]);
}

/// The shapes in which servers leave the call of a tool in the fields for it.
#[test]
fn a_tool_call_is_read_from_every_shape_of_its_fields() {
    let arguments = r#"{"way": 2}"#;
    for message in [
        json!({ "tool_calls": [{ "function": { "name": "step", "arguments": arguments } }] }),
        json!({ "tool_calls": [{ "function": { "name": "step", "arguments": { "way": 2 } } }] }),
        json!({ "tool_calls": [{ "function": { "name": "step", "arguments": r#""{\"way\":2}""# } }] }),
        json!({ "tool_calls": [{ "function": { "name": "step", "arguments": "{\"way\":2}<|tool_call_end|>" } }] }),
        json!({ "tool_calls": [{ "function": { "name": "step<|channel|>commentary", "arguments": arguments } }] }),
        json!({ "tool_calls": [{ "function": { "name": "step</think>", "arguments": arguments } }] }),
        json!({ "tool_calls": [{ "name": "step", "parameters": { "way": 2 } }] }),
        json!({ "tool_calls": { "function": { "name": "step", "arguments": arguments } } }),
        json!({ "tool_calls": { "0": { "function": { "name": "step", "arguments": arguments } } } }),
        json!({ "tool_calls": [], "function_call": { "name": "step", "arguments": arguments } }),
        json!({ "reasoning_content": "left", "tool_calls": [{ "function": { "name": "step", "arguments": arguments } }] }),
    ] {
        let reply = ServiceDialect::OpenAi.read_reply(&json!({ "choices": [{ "message": message }] })).unwrap();
        assert_eq!((reply.text.as_str(), reply.end), ("step {\"way\":2}", ReplyEnd::Stop), "{message}");
    }
    let thought = json!({ "choices": [{ "message": { "content": null, "reasoning_content": "left" } }] });
    assert_eq!(ServiceDialect::OpenAi.read_reply(&thought).unwrap().end, ReplyEnd::Thought);
}

#[test]
fn completions_get_one_prompt() {
    let completions = provider("completions", "");
    let lone = wire(&completions, &[line(MessageRole::User, "Write a haiku.")]).unwrap();
    assert_eq!(lone.path, "/completions");
    assert_eq!(lone.body["prompt"], "Write a haiku.");
    let lines = &conversation()[..3];
    let talk = wire(&completions, lines).unwrap().body;
    assert_eq!(talk["prompt"], "Be brief.\n\nUser: Hi.\nAssistant: Yes?\nAssistant:");
    assert_eq!(talk["stop"], json!(["\nUser:"]));
    assert!(wire(&completions, &conversation()).unwrap_err().contains("no pictures"));
}

fn heard(dialect: ServiceDialect, body: &Value) -> DialectReply {
    dialect.read_reply(body).unwrap()
}

#[test]
fn every_dialects_reply_is_understood() {
    let replies = [
        (
            ServiceDialect::OpenAi,
            json!({ "choices": [{ "message": { "role": "assistant", "content": "<think>sofa?</think>\nA sofa.",
                "reasoning_content": "hm" }, "finish_reason": "stop" }],
                "usage": { "prompt_tokens": 7, "completion_tokens": 3 } }),
        ),
        (
            ServiceDialect::OpenAi,
            json!({ "choices": [{ "message": { "content": [{ "type": "thinking", "thinking": [] },
                { "type": "text", "text": "A sofa." }] }, "finish_reason": "stop" }],
                "usage": { "prompt_tokens": 7, "completion_tokens": 3 } }),
        ),
        (
            ServiceDialect::Completions,
            json!({ "choices": [{ "text": " A sofa.\n", "finish_reason": "stop" }],
                "usage": { "prompt_tokens": 7, "completion_tokens": 3 } }),
        ),
        (
            ServiceDialect::Anthropic,
            json!({ "content": [{ "type": "thinking", "thinking": "hm" }, { "type": "text", "text": "A sofa." }],
                "stop_reason": "end_turn", "usage": { "input_tokens": 7, "output_tokens": 3 } }),
        ),
        (
            ServiceDialect::Gemini,
            json!({ "candidates": [{ "content": { "parts": [{ "text": "hm", "thought": true }, { "text": "A sofa." }] },
                "finishReason": "STOP" }],
                "usageMetadata": { "promptTokenCount": 7, "candidatesTokenCount": 2, "thoughtsTokenCount": 1 } }),
        ),
        (
            ServiceDialect::Ollama,
            json!({ "message": { "role": "assistant", "content": "A sofa.", "thinking": "hm" }, "done_reason": "stop",
                "prompt_eval_count": 7, "eval_count": 3 }),
        ),
    ];
    let expected =
        DialectReply { text: "A sofa.".to_owned(), end: ReplyEnd::Stop, tokens_in: Some(7), tokens_out: Some(3) };
    for (dialect, body) in replies {
        assert_eq!(heard(dialect, &body), expected, "{dialect:?}");
    }
}

#[test]
fn every_way_to_end_is_understood() {
    let chat = |message: Value, reason: &str| json!({ "choices": [{ "message": message, "finish_reason": reason }] });
    let said = json!({ "content": "A" });
    assert_eq!(heard(ServiceDialect::OpenAi, &chat(said.clone(), "length")).end, ReplyEnd::Length);
    assert!(matches!(heard(ServiceDialect::OpenAi, &chat(said, "content_filter")).end, ReplyEnd::Filtered(_)));
    let refusal = json!({ "content": null, "refusal": "I won't." });
    assert_eq!(heard(ServiceDialect::OpenAi, &chat(refusal, "stop")).end, ReplyEnd::Refused("I won't.".to_owned()));
    let message = |reason: &str| json!({ "content": [], "stop_reason": reason });
    assert_eq!(heard(ServiceDialect::Anthropic, &message("max_tokens")).end, ReplyEnd::Length);
    assert!(matches!(heard(ServiceDialect::Anthropic, &message("refusal")).end, ReplyEnd::Refused(_)));
    let candidate = |reason: &str| json!({ "candidates": [{ "finishReason": reason }] });
    assert_eq!(heard(ServiceDialect::Gemini, &candidate("MAX_TOKENS")).end, ReplyEnd::Length);
    assert_eq!(heard(ServiceDialect::Gemini, &candidate("SAFETY")).end, ReplyEnd::Filtered("SAFETY".to_owned()));
    let blocked = json!({ "promptFeedback": { "blockReason": "OTHER" } });
    assert!(matches!(heard(ServiceDialect::Gemini, &blocked).end, ReplyEnd::Filtered(_)));
    let done = json!({ "message": { "content": "A" }, "done_reason": "length" });
    assert_eq!(heard(ServiceDialect::Ollama, &done).end, ReplyEnd::Length);
}

#[test]
fn heard_names_the_field_that_a_reply_lacks() {
    for dialect in [
        ServiceDialect::OpenAi,
        ServiceDialect::Completions,
        ServiceDialect::Anthropic,
        ServiceDialect::Gemini,
        ServiceDialect::Ollama,
    ] {
        for body in [
            json!({}),
            json!([]),
            json!("x"),
            json!({ "choices": [], "candidates": [], "content": 3, "message": null }),
        ] {
            assert!(dialect.read_reply(&body).is_err(), "{dialect:?} {body}");
        }
    }
}

#[test]
fn models_are_listed() {
    let openai = json!({ "data": [{ "id": "a" }, { "x": 1 }, { "id": "b" }] });
    assert_eq!(ServiceDialect::OpenAi.listed_models(&openai), Some(vec!["a", "b"]));
    let gemini = json!({ "models": [{ "name": "models/gemini-2.5-flash" }] });
    assert_eq!(ServiceDialect::Gemini.listed_models(&gemini), Some(vec!["gemini-2.5-flash"]));
    assert_eq!(ServiceDialect::Ollama.listed_models(&json!({})), None);
}

/// If its provider fails, OpenRouter sends the text until then, with the error in the choice.
#[test]
fn a_choice_that_broke_is_no_answer() {
    let said = json!({ "content": "A so" });
    let choices = [
        (ServiceDialect::OpenAi, json!({ "message": said, "finish_reason": "error", "error": { "code": 502 } })),
        (ServiceDialect::OpenAi, json!({ "message": said, "error": { "message": "died" } })),
        (ServiceDialect::OpenAi, json!({ "message": said, "finish_reason": "error" })),
        (ServiceDialect::Completions, json!({ "text": "A so", "finish_reason": "error" })),
    ];
    for (dialect, choice) in choices {
        assert!(dialect.read_reply(&json!({ "choices": [choice] })).is_err(), "{choice}");
    }
    let whole = json!({ "message": said, "finish_reason": "stop", "error": null });
    assert_eq!(heard(ServiceDialect::OpenAi, &json!({ "choices": [whole] })).text, "A so");
}

/// xAI counts thinking in the total alone.
#[test]
fn thinking_that_only_the_total_counts_is_counted() {
    let tokens_out = |usage: Value| {
        let body = json!({ "choices": [{ "message": { "content": "A" } }], "usage": usage });
        heard(ServiceDialect::OpenAi, &body).tokens_out
    };
    assert_eq!(tokens_out(json!({ "prompt_tokens": 12, "completion_tokens": 1, "total_tokens": 399 })), Some(387));
    assert_eq!(tokens_out(json!({ "prompt_tokens": 12, "completion_tokens": 3, "total_tokens": 15 })), Some(3));
    assert_eq!(tokens_out(json!({ "prompt_tokens": 12, "completion_tokens": 3 })), Some(3));
    assert_eq!(tokens_out(json!({ "prompt_tokens": 12, "total_tokens": 1 })), Some(0));
    assert_eq!(tokens_out(json!({ "total_tokens": 9 })), None);
}

#[test]
fn several_pictures_of_a_message_are_sent_in_their_order() {
    let picture = |data: &str| Arc::new(EncodedPicture { base64: data.to_owned(), sha256: data.to_owned() });
    let lines = [RemoteMessage { pictures: vec![picture("QQ"), picture("Qg")], ..line(MessageRole::User, "Write.") }];
    for name in ["openai", "anthropic", "gemini", "ollama"] {
        let body = wire(&provider(name, ""), &lines).unwrap().body.to_string();
        let places = ["QQ", "Qg"].map(|data| body.find(&format!("{data}\"")).unwrap());
        assert!(places[0] < places[1], "{name}: {body}");
    }
    let config = "[providers.completions]\nbase_url = \"http://127.0.0.1:1/v1\"";
    assert!(wire(&provider("completions", config), &lines).unwrap_err().contains("takes no pictures"));
}

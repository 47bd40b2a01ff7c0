//! The provider answers in each dialect's shape, keeps to its rate, and commits the faults that it is given.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use serde_json::{Value, json};
use std::{
    io::{Read, Write},
    net::TcpStream,
    time::Duration,
};
use wayword_testkit::provider::{
    FaultSchedule, ModelScript, ProviderBehaviour, ProviderDialect, ProviderRequestRate, RetryAfter, ScriptRequest,
    ScriptedProvider, ServiceFault,
};

/// Status, head and body of a POST.
fn post(base: &str, path: &str, headers: &str, body: &Value) -> std::io::Result<(u16, String, String)> {
    let address = base.strip_prefix("http://").unwrap().split('/').next().unwrap();
    let mut stream = TcpStream::connect(address)?;
    stream.set_read_timeout(Some(Duration::from_secs(5)))?;
    let body = body.to_string();
    write!(
        stream,
        "POST {path} HTTP/1.1\r\nhost: x\r\nconnection: close\r\ncontent-type: application/json\r\n{headers}content-length: {}\r\n\r\n{body}",
        body.len()
    )?;
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer)?;
    let answer = String::from_utf8(answer).unwrap();
    let (head, body) = answer.split_once("\r\n\r\n").ok_or(std::io::ErrorKind::UnexpectedEof)?;
    Ok((head[9..12].parse().unwrap(), head.to_lowercase(), body.to_owned()))
}

fn chat(text: &str) -> Value {
    json!({ "model": "words", "messages": [{ "role": "user", "content": text }], "max_tokens": 5 })
}

fn provider(behaviour: ProviderBehaviour) -> (ScriptedProvider, String) {
    let provider = ScriptedProvider::start(behaviour).unwrap();
    let base = provider.base_url(ProviderDialect::OpenAi);
    (provider, base)
}

fn behaviour(script: impl ModelScript + Clone + 'static) -> ProviderBehaviour {
    ProviderBehaviour::for_model("words", script.clone()).and_model("m", script.clone()).and_model("g", script)
}

fn echo(heard: &ScriptRequest) -> String {
    format!("{} {} {}", heard.model, heard.prompt(), heard.pictures.len())
}

#[test]
fn each_dialect_is_heard_and_answered_in_its_shape() {
    let (_provider, base) = provider(behaviour(echo));
    let image = json!({ "type": "image_url", "image_url": { "url": "data:image/jpeg;base64,AAAA" } });
    let parts = json!([{ "type": "text", "text": "hi" }, image]);
    let cases = [
        (
            "/v1/chat/completions",
            json!({ "model": "m", "messages": [{ "role": "user", "content": parts }] }),
            "/choices/0/message/content",
            "m hi 1",
        ),
        ("/v1/completions", json!({ "model": "m", "prompt": "hi" }), "/choices/0/text", "m hi 0"),
        (
            "/v1/messages",
            json!({ "model": "m", "max_tokens": 9, "messages": [{ "role": "user", "content": [
                { "type": "image", "source": { "type": "base64", "media_type": "image/jpeg", "data": "AAAA" } }, { "type": "text", "text": "hi" }] }] }),
            "/content/0/text",
            "m hi 1",
        ),
        (
            "/v1beta/models/g:generateContent",
            json!({ "contents": [{ "role": "user", "parts": [{ "text": "hi" }, { "inlineData": { "mimeType": "image/jpeg", "data": "AAAA" } }] }] }),
            "/candidates/0/content/parts/0/text",
            "g hi 1",
        ),
        (
            "/api/chat",
            json!({ "model": "m", "messages": [{ "role": "user", "content": "hi", "images": ["AAAA"] }], "stream": false }),
            "/message/content",
            "m hi 1",
        ),
    ];
    for (path, body, pointer, wanted) in cases {
        let (status, _, answer) = post(&base, path, "", &body).unwrap();
        assert_eq!(status, 200, "{path}: {answer}");
        let answer: Value = serde_json::from_str(&answer).unwrap();
        assert_eq!((status, answer.pointer(pointer).unwrap().as_str().unwrap()), (200, wanted), "{path}");
    }
}

#[test]
fn a_limit_of_tokens_cuts_the_reply_off() {
    let (_provider, base) = provider(behaviour(|_: &ScriptRequest| "one two three four five six".to_owned()));
    let (_, _, answer) = post(&base, "/v1/chat/completions", "", &chat("go")).unwrap();
    let answer: Value = serde_json::from_str(&answer).unwrap();
    assert_eq!(answer["choices"][0]["finish_reason"], "length");
    assert_eq!(answer["choices"][0]["message"]["content"], "one two three four five");
}

#[test]
fn a_wrong_key_is_refused_in_every_dialect() {
    let (provider, base) = provider(ProviderBehaviour { key: Some("right".into()), ..behaviour(echo) });
    for (path, header) in [("/v1/chat/completions", "authorization: Bearer "), ("/v1/messages", "x-api-key: ")] {
        assert_eq!(post(&base, path, &format!("{header}wrong\r\n"), &chat("x")).unwrap().0, 401);
        assert_eq!(post(&base, path, &format!("{header}right\r\n"), &chat("x")).unwrap().0, 200);
    }
    assert_eq!((provider.log().answered, provider.log().key_refused), (2, 2));
}

#[test]
fn each_fault_breaks_the_response_as_its_name_promises() {
    let faults = [
        ServiceFault::Overloaded,
        ServiceFault::TooMany(RetryAfter::Milliseconds),
        ServiceFault::TooMany(RetryAfter::RetryInfo),
        ServiceFault::Truncated,
        ServiceFault::NoChoices,
        ServiceFault::ErrorInOk,
        ServiceFault::Filtered,
        ServiceFault::Reset,
        ServiceFault::Closed,
    ];
    let faults = FaultSchedule::default().with_first_faults(&faults.map(Some));
    let (provider, base) = provider(ProviderBehaviour { faults, ..behaviour(echo) });
    let ask = || post(&base, "/v1/chat/completions", "", &chat("hello"));
    assert_eq!(ask().unwrap().0, 529);
    assert!(ask().unwrap().1.contains("retry-after-ms: 50"));
    assert!(ask().unwrap().2.contains("retryDelay"));
    assert!(serde_json::from_str::<Value>(&ask().unwrap().2).is_err());
    assert!(ask().unwrap().2.contains("\"choices\":[]"));
    let (status, _, body) = ask().unwrap();
    assert!(status == 200 && body.contains("error"));
    assert!(ask().unwrap().2.contains("content_filter"));
    assert!(ask().is_err(), "the connection is reset in the middle");
    assert!(ask().is_err(), "the connection is closed");
    assert_eq!(ask().unwrap().0, 200);
    let log = provider.log();
    assert_eq!((log.faults_committed(), log.answered, log.received), (9, 1, 10));
}

#[test]
fn requests_above_the_rate_are_rejected_and_not_admitted() {
    let rate = ProviderRequestRate { requests_per_s: 0.5, burst: 3, retry_after: RetryAfter::Seconds };
    let (provider, base) = provider(ProviderBehaviour { rate: Some(rate), ..behaviour(echo) });
    let statuses: Vec<u16> = (0..6).map(|_| post(&base, "/v1/chat/completions", "", &chat("x")).unwrap().0).collect();
    assert_eq!(statuses, [200, 200, 200, 429, 429, 429]);
    assert_eq!((provider.log().rate_limited, provider.log().admitted), (3, 3));
}

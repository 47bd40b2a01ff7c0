//! Each dialect reports faults, keys, token counts and waits in its own form.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use serde_json::{Value, json};
use std::{
    io::{ErrorKind, Read, Write},
    net::TcpStream,
    time::{Duration, Instant},
};
use wayword_testkit::provider::{
    FaultSchedule, ProviderBehaviour, ProviderDialect, RetryAfter, ScriptRequest, ScriptedProvider, ServiceFault,
};

const KEY: &str = "a-key-of-nobody";

fn provider(faults: FaultSchedule) -> ScriptedProvider {
    let words = |_: &ScriptRequest| "one two three four five six".to_owned();
    ScriptedProvider::start(ProviderBehaviour {
        faults,
        key: Some(KEY.into()),
        ..ProviderBehaviour::for_model("m", words)
    })
    .unwrap()
}

fn changed(mut faults: FaultSchedule, change: impl FnOnce(&mut FaultSchedule)) -> FaultSchedule {
    change(&mut faults);
    faults
}

/// The path, the key's header and a request, for each dialect.
fn requests() -> [(ProviderDialect, &'static str, &'static str, Value); 5] {
    let messages = json!([{ "role": "user", "content": "hi" }]);
    [
        (
            ProviderDialect::OpenAi,
            "/chat/completions",
            "authorization: Bearer",
            json!({ "model": "m", "messages": messages }),
        ),
        (
            ProviderDialect::Completions,
            "/completions",
            "authorization: Bearer",
            json!({ "model": "m", "prompt": "hi" }),
        ),
        (
            ProviderDialect::Anthropic,
            "/messages",
            "x-api-key:",
            json!({ "model": "m", "max_tokens": 99, "messages": messages }),
        ),
        (
            ProviderDialect::Gemini,
            "/models/m:generateContent",
            "x-goog-api-key:",
            json!({ "contents": [{ "role": "user", "parts": [{ "text": "hi" }] }] }),
        ),
        (
            ProviderDialect::Ollama,
            "/api/chat",
            "authorization: Bearer",
            json!({ "model": "m", "messages": messages, "stream": false }),
        ),
    ]
}

/// Opens a connection and sends a request on it: a POST, or a GET if there is no body.
fn sent(base: &str, path: &str, header: &str, body: Option<&Value>) -> TcpStream {
    let (address, root) = base.strip_prefix("http://").unwrap().split_once('/').unwrap_or((&base[7..], ""));
    let root = if root.is_empty() { String::new() } else { format!("/{root}") };
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
    let method = if body.is_some() { "POST" } else { "GET" };
    let body = body.map(Value::to_string).unwrap_or_default();
    let length = body.len();
    let head = format!("{method} {root}{path} HTTP/1.1\r\nhost: x\r\nconnection: close\r\n{header}\r\n");
    write!(stream, "{head}content-length: {length}\r\n\r\n{body}").unwrap();
    stream
}

/// Status, head and body.
fn answered(mut stream: TcpStream) -> (u16, String, String) {
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let (head, body) = answer.split_once("\r\n\r\n").unwrap();
    (head[9..12].parse().unwrap(), head.to_lowercase(), body.to_owned())
}

fn ask(provider: &ScriptedProvider) -> TcpStream {
    let (dialect, path, header, body) = &requests()[0];
    sent(&provider.base_url(*dialect), path, &format!("{header} {KEY}"), Some(body))
}

#[test]
fn every_dialect_requires_its_key_and_counts_its_tokens() {
    let provider = provider(FaultSchedule::default());
    for (dialect, path, header, body) in requests() {
        let base = provider.base_url(dialect);
        assert_eq!(answered(sent(&base, path, &format!("{header} wrong"), Some(&body))).0, 401, "{dialect:?}");
        let (status, _, text) = answered(sent(&base, path, &format!("{header} {KEY}"), Some(&body)));
        assert_eq!(status, 200, "{dialect:?}: {text}");
        let answer: Value = serde_json::from_str(&text).unwrap();
        let (tokens_in, tokens_out, finish) = match dialect {
            ProviderDialect::OpenAi | ProviderDialect::Completions => {
                ("/usage/prompt_tokens", "/usage/completion_tokens", "/choices/0/finish_reason")
            }
            ProviderDialect::Anthropic => ("/usage/input_tokens", "/usage/output_tokens", "/stop_reason"),
            ProviderDialect::Gemini => {
                ("/usageMetadata/promptTokenCount", "/usageMetadata/candidatesTokenCount", "/candidates/0/finishReason")
            }
            ProviderDialect::Ollama => ("/prompt_eval_count", "/eval_count", "/done_reason"),
        };
        assert_eq!(answer.pointer(tokens_in), Some(&json!(1)), "{dialect:?}");
        assert_eq!(answer.pointer(tokens_out), Some(&json!(7)), "{dialect:?}");
        let finish = answer.pointer(finish).unwrap().as_str().unwrap().to_lowercase();
        assert!(["stop", "end_turn"].contains(&finish.as_str()), "{dialect:?}: {finish}");
    }
    assert_eq!((provider.log().key_refused, provider.log().answered), (5, 5));
}

#[test]
fn models_are_listed_as_each_dialect_does() {
    let provider = provider(FaultSchedule::default());
    for (dialect, path, header, pointer) in [
        (ProviderDialect::OpenAi, "/models", "authorization: Bearer", "/data/0/id"),
        (ProviderDialect::Anthropic, "/models?limit=1000", "x-api-key:", "/data/0/id"),
        (ProviderDialect::Gemini, "/models?pageSize=1000", "x-goog-api-key:", "/models/0/name"),
        (ProviderDialect::Ollama, "/api/tags", "authorization: Bearer", "/models/0/name"),
    ] {
        let base = provider.base_url(dialect);
        assert_eq!(answered(sent(&base, path, &format!("{header} wrong"), None)).0, 401, "{dialect:?}");
        let (status, _, body) = answered(sent(&base, path, &format!("{header} {KEY}"), None));
        let list: Value = serde_json::from_str(&body).unwrap();
        let name = list.pointer(pointer).unwrap().as_str().unwrap();
        assert_eq!((status, name.trim_start_matches("models/")), (200, "m"), "{dialect:?}");
    }
}

#[test]
fn a_429_announces_its_wait_in_every_form() {
    let faults = RetryAfter::ALL.map(|form| Some(ServiceFault::TooMany(form)));
    let provider = provider(FaultSchedule::default().with_first_faults(&faults));
    for form in RetryAfter::ALL {
        let (status, head, body) = answered(ask(&provider));
        assert_eq!(status, 429);
        let wanted = match form {
            RetryAfter::Silent => "",
            RetryAfter::Seconds => "retry-after: 1\r",
            RetryAfter::Decimal => "retry-after: 0.050",
            RetryAfter::HttpDate => " gmt",
            RetryAfter::Milliseconds => "retry-after-ms: 50",
            RetryAfter::Reset => "x-ratelimit-reset-requests: 50ms",
            RetryAfter::RetryInfo => "",
        };
        assert!(format!("{head}\r\n").contains(wanted), "{form:?}: {head}");
        assert_eq!(body.contains("\"retryDelay\":\"0.050s\""), form == RetryAfter::RetryInfo, "{body}");
        let tells = head.contains("retry-after") || head.contains("ratelimit");
        assert_eq!(tells, !matches!(form, RetryAfter::Silent | RetryAfter::RetryInfo), "{form:?}: {head}");
    }
}

#[test]
fn a_reset_comes_in_the_middle_of_the_body_and_a_close_before_any_byte() {
    let provider =
        provider(FaultSchedule::default().with_first_faults(&[Some(ServiceFault::Reset), Some(ServiceFault::Closed)]));
    let mut got = Vec::new();
    let error = ask(&provider).read_to_end(&mut got).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::ConnectionReset);
    let text = String::from_utf8(got).unwrap();
    let (head, body) = text.split_once("\r\n\r\n").unwrap();
    assert!(head.starts_with("HTTP/1.1 200") && !body.is_empty() && !body.ends_with('}'), "{text}");
    let mut got = Vec::new();
    let closed = ask(&provider).read_to_end(&mut got);
    assert!(got.is_empty() && closed.is_ok_and(|bytes| bytes == 0));
}

#[test]
fn a_trickle_takes_its_time_and_an_endless_body_does_not_end() {
    let faults = changed(FaultSchedule::default(), |faults| faults.trickle = Duration::from_millis(2));
    let provider = provider(faults.with_first_faults(&[Some(ServiceFault::Trickle), Some(ServiceFault::Endless)]));
    let start = Instant::now();
    let (_, _, body) = answered(ask(&provider));
    assert!(start.elapsed() >= Duration::from_millis(2) * u32::try_from(body.len()).unwrap());
    assert!(serde_json::from_str::<Value>(&body).is_ok(), "{body}");
    let mut endless = ask(&provider);
    let mut buffer = vec![0; 4 << 20];
    endless.read_exact(&mut buffer).unwrap();
    assert!(buffer.starts_with(b"HTTP/1.1 200") && buffer.ends_with(b"ww"));
    drop(endless);
    assert_eq!(answered(ask(&provider)).0, 200);
}

#[test]
fn keys_and_quotas_run_out_and_errors_can_repeat_the_key() {
    let revoked = provider(changed(FaultSchedule::default(), |faults| faults.key_refused_after = Some(2)));
    assert_eq!([0; 4].map(|_| answered(ask(&revoked)).0), [200, 200, 401, 401]);
    let empty = provider(changed(FaultSchedule::default(), |faults| faults.quota_after = Some(1)));
    assert_eq!(answered(ask(&empty)).0, 200);
    for ((dialect, path, header, body), (status, mark)) in requests().into_iter().zip([
        (429, "insufficient_quota"),
        (429, "insufficient_quota"),
        (400, "credit balance is too low"),
        (429, "PerDay"),
        (402, "quota"),
    ]) {
        let got = answered(sent(&empty.base_url(dialect), path, &format!("{header} {KEY}"), Some(&body)));
        assert!(got.0 == status && got.2.contains(mark), "{dialect:?}: {got:?}");
    }
    assert_eq!(empty.log().out_of_quota, 5);
    let echoing = provider(FaultSchedule::default().with_first_faults(&[Some(ServiceFault::EchoesKey)]));
    let (status, _, body) = answered(ask(&echoing));
    assert!(status == 500 && body.contains(KEY));
}

#[test]
fn equal_requests_are_counted_by_their_outcome() {
    let provider = provider(FaultSchedule::default().with_first_faults(&[Some(ServiceFault::Server), None, None]));
    assert_eq!([0; 3].map(|_| answered(ask(&provider)).0), [500, 200, 200]);
    let log = provider.log();
    let bodies: Vec<_> = log.bodies.values().map(|body| (body.received, body.admitted, body.answered)).collect();
    assert_eq!((bodies.as_slice(), log.answered_again(), log.distinct_answered()), ([(3, 3, 2)].as_slice(), 1, 1));
    assert_eq!(provider.request_count(), 3);
}

#[test]
fn two_runs_of_a_storm_meet_the_same_faults_in_any_order() {
    let storm = |reversed: bool| {
        let provider = provider(changed(FaultSchedule::storm(0.6), |faults| faults.trickle = Duration::ZERO));
        let (dialect, path, header, _) = &requests()[0];
        let base = provider.base_url(*dialect);
        let mut numbers: Vec<usize> = (0..120).collect();
        if reversed {
            numbers.reverse();
        }
        for number in numbers {
            let text = format!("request {number}");
            let body = json!({ "model": "m", "messages": [{ "role": "user", "content": text }] });
            let mut all = Vec::new();
            // Some of the connections break, as they should.
            let _ = sent(&base, path, &format!("{header} {KEY}"), Some(&body)).read_to_end(&mut all);
        }
        provider.log()
    };
    let log = storm(false);
    assert!((50..95).contains(&log.faults_committed()) && log.faults.len() > 10, "{:?}", log.faults);
    assert_eq!(log.faults_committed() + log.answered, 120);
    let reversed = storm(true);
    assert_eq!((log.faults, log.bodies), (reversed.faults, reversed.bodies));
}

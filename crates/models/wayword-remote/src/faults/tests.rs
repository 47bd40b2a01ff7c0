use super::*;
use std::io::ErrorKind;
use ureq::{Timeout, http::HeaderValue};

fn who(secret: Option<&ServiceSecret>) -> FaultContext<'_> {
    FaultContext {
        provider: "openai",
        key_env: Some("OPENAI_API_KEY"),
        secret,
        version_path: "/v1",
        has_answered: false,
    }
}

fn fault(status: u16, body: &str) -> RemoteFault {
    fault_from_response(status, &HeaderMap::new(), body.as_bytes(), SystemTime::UNIX_EPOCH, who(None))
}

/// A fault's kind in the table below: again, load (over), paid, once (more), final or stop.
fn kind(fault: &RemoteFault) -> &'static str {
    match fault {
        RemoteFault::Retry(RetryFault { load: ServiceLoad::Over, .. }) => "load",
        RemoteFault::Retry(RetryFault { maybe_paid: true, .. }) => "paid",
        RemoteFault::Retry(_) => "again",
        RemoteFault::Unreadable { .. } => "once",
        RemoteFault::Final { .. } => "final",
        RemoteFault::Stop { .. } => "stop",
    }
}

#[test]
fn every_status_and_body_has_its_meaning() {
    let table = [
        (400, r#"{"error":{"message":"context too long","code":"context_length_exceeded"}}"#, "final"),
        (
            400,
            r#"{"error":{"code":400,"message":"API key not valid.","details":[{"reason":"API_KEY_INVALID"}]}}"#,
            "stop",
        ),
        (
            400,
            r#"{"type":"error","error":{"type":"invalid_request_error","message":"Your credit balance is too low"}}"#,
            "stop",
        ),
        (401, "", "stop"),
        (402, r#"{"error":{"message":"Insufficient Balance"}}"#, "stop"),
        (403, "", "stop"),
        (403, r#"{"error":{"message":"Your input was flagged","code":403}}"#, "final"),
        (404, r#"{"error":"model 'x' not found"}"#, "stop"),
        (404, r#"{"object":"error","message":"The model `m` does not exist.","code":404}"#, "stop"),
        (404, r#"{"detail":"Not Found"}"#, "stop"),
        (404, "<html>", "stop"),
        (405, "", "stop"),
        (501, "", "stop"),
        (407, "", "stop"),
        (404, r#"{"error":{"message":"No endpoints found that support image input","code":404}}"#, "stop"),
        (400, "<html><title>400 The plain HTTP request was sent to HTTPS port</title>", "stop"),
        (400, "Client sent an HTTP request to an HTTPS server.", "stop"),
        (500, r#"{"error":"model requires more system memory (9.1 GiB) than is available (7.0 GiB)"}"#, "stop"),
        (400, r#"{"object":"error","message":"m is not a multimodal model"}"#, "stop"),
        (200, r#"{"error":"Unexpected endpoint or method. (POST /chat/completions)"}"#, "stop"),
        (400, r#"{"error":"'response_format.type' must be 'json_schema' or 'text'"}"#, "stop"),
        (400, r#"{"error":{"message":"This response_format type is unavailable now"}}"#, "stop"),
        (400, r#"{"error":"registry.ollama.ai/library/m:latest does not support tools"}"#, "stop"),
        (400, r#"{"error":"\"m\" does not support thinking"}"#, "stop"),
        (400, r#"{"error":{"message":"invalid temperature: only 1 is allowed for this model"}}"#, "stop"),
        (
            500,
            r#"{"error":{"code":500,"message":"image input is not supported - hint: you may need the mmproj"}}"#,
            "stop",
        ),
        (400, r#"{"error":{"message":"messages[0]: unknown variant `image_url`, expected `text`"}}"#, "stop"),
        (
            400,
            r#"{"error":{"code":400,"message":"request (9412 tokens) exceeds the available context size"}}"#,
            "final",
        ),
        (408, "", "again"),
        (409, "", "again"),
        (413, "", "final"),
        (422, r#"{"detail":[{"msg":"field required"}]}"#, "final"),
        (429, "", "load"),
        (429, r#"{"error":{"message":"Rate limit reached","type":"requests","code":"rate_limit_exceeded"}}"#, "load"),
        (429, r#"{"error":{"message":"You exceeded your current quota","code":"insufficient_quota"}}"#, "stop"),
        (
            429,
            r#"{"error":{"code":429,"status":"RESOURCE_EXHAUSTED","message":"You exceeded your current quota","details":[
                {"violations":[{"quotaId":"GenerateRequestsPerMinutePerProjectPerModel-FreeTier"}]},{"retryDelay":"34s"}]}}"#,
            "load",
        ),
        (
            429,
            r#"{"error":{"code":429,"status":"RESOURCE_EXHAUSTED","details":[
                {"violations":[{"quotaId":"GenerateRequestsPerDayPerProjectPerModel-FreeTier"}]},{"retryDelay":"34s"}]}}"#,
            "stop",
        ),
        (500, "oops", "again"),
        (502, "<html>", "again"),
        (503, "", "again"),
        (529, r#"{"type":"error","error":{"type":"overloaded_error","message":"Overloaded"}}"#, "load"),
        (200, r#"{"error":{"message":"upstream failed","code":502}}"#, "again"),
        (200, r#"{"error":{"message":"slow down","code":429}}"#, "load"),
        (200, r#"{"type":"error","error":{"type":"overloaded_error","message":"Overloaded"}}"#, "load"),
        (200, r#"{"error":"something"}"#, "once"),
        (200, r#"{"choices":[{"error":{"code":401,"message":"No auth"}}]}"#, "stop"),
        (307, "", "stop"),
    ];
    for (status, body, expected) in table {
        assert_eq!(kind(&fault(status, body)), expected, "{status} {body}");
    }
}

#[test]
fn fault_from_response_stops_on_a_long_wait_and_retries_after_a_short_one() {
    let with = |status, wait: &'static str| {
        let headers = HeaderMap::from_iter([(ureq::http::header::RETRY_AFTER, HeaderValue::from_static(wait))]);
        fault_from_response(status, &headers, b"", SystemTime::UNIX_EPOCH, who(None))
    };
    assert!(matches!(with(429, "86400"), RemoteFault::Stop { reason, .. } if reason.contains("1440 minutes")));
    assert!(
        matches!(with(429, "30"), RemoteFault::Retry(RetryFault { after: Some(wait), .. }) if wait.as_secs() == 30)
    );
    assert_eq!(kind(&with(503, "30")), "load");
}

#[test]
fn fault_reasons_are_short_and_contain_no_key() {
    let secret = ServiceSecret::new("sk-0123456789abcdef").unwrap();
    let body = format!(r#"{{"error":{{"message":"Incorrect API key sk-0123456789abcdef {}"}}}}"#, "x".repeat(5000));
    for status in [200, 400, 401, 429, 500] {
        let fault =
            fault_from_response(status, &HeaderMap::new(), body.as_bytes(), SystemTime::UNIX_EPOCH, who(Some(&secret)));
        let text = format!("{fault:?}");
        assert!(text.contains("***") && !text.contains("0123456789"), "{text}");
        assert!(fault.reason().chars().count() < 400);
    }
}

#[test]
fn a_fault_of_a_setting_stops_with_the_setting_to_write() {
    let hint = |message: &str| match fault(400, &format!(r#"{{"error":{{"message":"{message}"}}}}"#)) {
        RemoteFault::Stop { hint, .. } => hint,
        other => panic!("{other:?}"),
    };
    for (message, setting) in [
        ("Unsupported value: 'temperature' does not support 0.6 with this model.", "omit = [\"temperature\"]"),
        ("Unsupported parameter: use 'max_completion_tokens' instead.", "max_tokens_field"),
        ("The model `m` does not exist or you do not have access to it.", "name of the model"),
        ("unknown variant `image_url`, expected `text`", "vision model with --see"),
    ] {
        assert!(hint(message).contains(setting), "{message}: {}", hint(message));
    }
}

/// Where the service answered before, its address is right, and one odd status ends one call.
#[test]
fn an_address_is_only_wrong_before_the_first_answer() {
    let of = |status, body: &str, has_answered| {
        let who = FaultContext { has_answered, ..who(None) };
        fault_from_response(status, &HeaderMap::new(), body.as_bytes(), SystemTime::UNIX_EPOCH, who)
    };
    for (status, body) in [(404, "<html>"), (404, ""), (404, r#"{"detail":"Not Found"}"#), (405, "Method Not Allowed")]
    {
        assert!(
            matches!(of(status, body, false), RemoteFault::Stop { hint, .. } if hint.contains("/v1")),
            "{status} {body}"
        );
        assert_eq!(kind(&of(status, body, true)), "final", "{status} {body}");
    }
    // The address of a model that is not there, and of one that an account may not use, is right.
    for (body, hint) in [
        (r#"{"error":{"message":"model `m` not found"}}"#, "doctor"),
        (r#"{"error":{"message":"No endpoints found matching your data policy"}}"#, "account"),
        (r#"{"error":{"message":"No endpoints found that support image input"}}"#, "--see"),
    ] {
        assert!(matches!(of(404, body, false), RemoteFault::Stop { hint: told, .. } if told.contains(hint)), "{body}");
    }
}

#[test]
fn a_request_that_is_too_long_comes_with_the_setting() {
    for (status, body) in [
        (400, r#"{"error":{"message":"too long","code":"context_length_exceeded"}}"#),
        (400, r#"{"error":{"code":400,"message":"request (9412 tokens) exceeds the available context size"}}"#),
        (
            400,
            r#"{"type":"error","error":{"type":"invalid_request_error","message":"prompt is too long: 210000 tokens"}}"#,
        ),
        (400, r#"{"object":"error","message":"This model's maximum context length is 4096 tokens."}"#),
        (413, "Request Entity Too Large"),
    ] {
        let fault = fault(status, body);
        assert!(
            matches!(&fault, RemoteFault::Final { hint: Some(hint), .. } if hint.contains("--picture-px")),
            "{fault:?}"
        );
    }
}

/// The words are those of rustls 0.23.
#[test]
fn a_certificate_that_is_not_valid_stops_with_what_to_do() {
    let of = |words: &str| {
        let error = ureq::Error::Io(std::io::Error::new(ErrorKind::InvalidData, words.to_owned()));
        fault_from_transport(&error, None, "https://h/v1", who(None))
    };
    for (words, what, to_do) in [
        ("invalid peer certificate: UnknownIssuer", "no authority", "SSL_CERT_FILE"),
        ("invalid peer certificate: Other(OtherError(CaUsedAsEndEntity))", "of an authority", "CA:FALSE"),
        ("invalid peer certificate: certificate expired: verification time 9 (UNIX)", "has expired", "clock"),
        ("invalid peer certificate: Expired", "has expired", "clock"),
        ("invalid peer certificate: certificate not valid yet: verification time 9", "not valid yet", "clock"),
        (
            "invalid peer certificate: certificate not valid for name \"h\"; certificate is only valid for DnsName(\"x\")",
            "another name",
            "base URL",
        ),
        ("received corrupt message of type InvalidContentType", "does not speak HTTPS", "http://"),
        ("received fatal alert: ProtocolVersion", "old form", "TLS 1.2"),
    ] {
        let fault = of(words);
        assert!(
            matches!(&fault, RemoteFault::Stop { reason, hint } if reason.contains(what) && hint.contains(to_do)),
            "{fault:?}"
        );
    }
    assert_eq!(kind(&of("unexpected end of file")), "paid");
}

#[test]
fn fault_from_transport_distinguishes_faults_before_and_after_sending() {
    let io = |kind| ureq::Error::Io(std::io::Error::new(kind, "x"));
    let of = |error: ureq::Error| fault_from_transport(&error, None, "http://h", who(None));
    assert_eq!(kind(&of(io(ErrorKind::ConnectionRefused))), "again");
    assert_eq!(kind(&of(io(ErrorKind::ConnectionReset))), "paid");
    assert_eq!(kind(&of(ureq::Error::HostNotFound)), "again");
    assert_eq!(kind(&of(ureq::Error::Timeout(Timeout::Connect))), "again");
    let slow = of(ureq::Error::Timeout(Timeout::Global));
    assert!(matches!(slow, RemoteFault::Retry(RetryFault { load: ServiceLoad::Slow, maybe_paid: true, .. })));
    assert_eq!(kind(&of(ureq::Error::BodyExceedsLimit(9))), "final");
}

/// A long reason is cut. The cut must not go through the key, because a part of the key would stay.
#[test]
fn no_part_of_a_key_stays_where_a_reason_is_cut() {
    let secret = ServiceSecret::new("sk-0123456789abcdef").unwrap();
    for before in 280..300 {
        let long = format!("{} sk-0123456789abcdef", "x".repeat(before));
        let far = format!("{}sk-0123456789abcdef", " ".repeat(3700 + before));
        for body in [format!(r#"{{"error":{{"message":"{long}"}}}}"#), long, far] {
            let who = who(Some(&secret));
            let fault = fault_from_response(500, &HeaderMap::new(), body.as_bytes(), SystemTime::UNIX_EPOCH, who);
            assert!(!fault.reason().contains("0123"), "{}", fault.reason());
        }
    }
}

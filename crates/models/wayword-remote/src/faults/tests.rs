use super::*;
use ureq::http::HeaderValue;

fn who(secret: Option<&ServiceSecret>) -> FaultContext<'_> {
    FaultContext { provider: "openai", key_env: Some("OPENAI_API_KEY"), secret }
}

fn fault(status: u16, body: &str) -> RemoteFault {
    fault_from_response(status, &HeaderMap::new(), body.as_bytes(), SystemTime::UNIX_EPOCH, who(None))
}

/// A fault's kind in the table below: again, load (over), paid, final or stop.
fn kind(fault: &RemoteFault) -> &'static str {
    match fault {
        RemoteFault::Retry(RetryFault { load: ServiceLoad::Over, .. }) => "load",
        RemoteFault::Retry(RetryFault { maybe_paid: true, .. }) => "paid",
        RemoteFault::Retry(_) => "again",
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
        (404, r#"{"detail":"Not Found"}"#, "final"),
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
        (200, r#"{"error":"something"}"#, "paid"),
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
        ("unknown variant `image_url`, expected `text`", "does not see"),
    ] {
        assert!(hint(message).contains(setting), "{message}: {}", hint(message));
    }
}

#[test]
fn a_page_of_html_stops_and_other_odd_bodies_are_asked_for_again() {
    let page = fault_of_odd_body(b"\n<!DOCTYPE html><html><title>Sign in</title>", true, who(None));
    assert!(is_html(b"\n<!DOCTYPE html>") && !is_html(b"{}"));
    assert!(matches!(page, RemoteFault::Stop { hint, .. } if hint.contains("base_url")));
    for body in ["", "<html>", "{\"choices\":", "data: {\"choices\":[]}\n"] {
        assert_eq!(kind(&fault_of_odd_body(body.as_bytes(), false, who(None))), "paid", "{body}");
    }
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

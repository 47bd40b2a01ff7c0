//! Reads from a response how long the service asks the program to wait. Services use several headers and forms of time
//! for this.

use super::{error_body::ServiceErrorBody, times};
use std::time::{Duration, SystemTime};
use ureq::http::HeaderMap;

/// Pairs of headers: how much of a limit is left, and when the limit is reset.
const LIMIT_HEADERS: [(&str, &str); 8] = [
    ("x-ratelimit-remaining-requests", "x-ratelimit-reset-requests"),
    ("x-ratelimit-remaining-tokens", "x-ratelimit-reset-tokens"),
    ("anthropic-ratelimit-requests-remaining", "anthropic-ratelimit-requests-reset"),
    ("anthropic-ratelimit-tokens-remaining", "anthropic-ratelimit-tokens-reset"),
    ("anthropic-ratelimit-input-tokens-remaining", "anthropic-ratelimit-input-tokens-reset"),
    ("anthropic-ratelimit-output-tokens-remaining", "anthropic-ratelimit-output-tokens-reset"),
    ("x-ratelimit-remaining", "x-ratelimit-reset"),
    ("ratelimit-remaining", "ratelimit-reset"),
];

/// The wait that a response asks for: `retry-after-ms`, then `retry-after`, then the delay in the body, then the
/// reset of a limit.
pub(super) fn requested_wait(headers: &HeaderMap, body: &ServiceErrorBody, now: SystemTime) -> Option<Duration> {
    let header = |name: &str| headers.get(name).and_then(|value| value.to_str().ok());
    let ms = || header("retry-after-ms").and_then(times::bare_seconds).map(|ms| ms / 1000);
    let plain = || header("retry-after").and_then(|text| retry_after(text, now));
    let in_words = || wait_in_words(&body.message);
    ms().or_else(plain).or(body.retry_delay).or_else(|| limit_reset_wait(header, now)).or_else(in_words)
}

/// The wait that a message names: "Please try again in 4.77s."
fn wait_in_words(message: &str) -> Option<Duration> {
    let message = message.to_ascii_lowercase();
    let behind = ["try again in ", "retry in ", "retry after "].iter().find_map(|words| message.split_once(words))?.1;
    let length = behind.split([' ', ',', ')']).next()?.trim_end_matches('.');
    let is_bare = behind[length.len()..].trim_start().starts_with("second");
    times::parse_duration(length).or_else(|| times::bare_seconds(length).filter(|_| is_bare))
}

/// The wait in any of the forms that services use: a moment or a length of time.
fn retry_after(text: &str, now: SystemTime) -> Option<Duration> {
    times::until_unix(text, now)
        .or_else(|| times::bare_seconds(text))
        .or_else(|| times::parse_duration(text))
        .or_else(|| times::until_http_date(text, now))
        .or_else(|| times::until_rfc_3339(text, now))
}

/// The wait until the latest reset of the limits that are used up. If no limit is used up, the request was too large
/// for the rest of a limit, so the earliest reset counts.
fn limit_reset_wait<'a>(header: impl Fn(&str) -> Option<&'a str>, now: SystemTime) -> Option<Duration> {
    let resets = LIMIT_HEADERS.iter().filter_map(|(remaining, reset)| {
        let amount_left = header(remaining).and_then(|text| text.trim().parse::<f64>().ok());
        Some((amount_left, retry_after(header(reset)?, now)?))
    });
    let resets: Vec<(Option<f64>, Duration)> = resets.collect();
    let used_up = resets
        .iter()
        .filter(|(amount_left, _)| amount_left.is_none_or(|amount_left| amount_left < 1.0))
        .map(|(_, reset)| *reset)
        .max();
    used_up.or_else(|| resets.iter().map(|(_, reset)| *reset).min())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use ureq::http::{HeaderName, HeaderValue};

    /// 2026-01-02T03:04:05Z
    fn now() -> SystemTime {
        SystemTime::UNIX_EPOCH + Duration::from_secs(1_767_323_045)
    }

    fn wait_s(pairs: &[(&'static str, &str)], body: &str) -> Option<f64> {
        let headers =
            pairs.iter().map(|(name, value)| (HeaderName::from_static(name), HeaderValue::from_str(value).unwrap()));
        requested_wait(&headers.collect(), &ServiceErrorBody::from_body(body.as_bytes()), now())
            .map(|wait| wait.as_secs_f64())
    }

    #[test]
    fn every_form_is_understood() {
        for (name, value, expected) in [
            ("retry-after", "7", 7.0),
            ("retry-after", "0.5", 0.5),
            ("retry-after", "Fri, 02 Jan 2026 03:04:25 GMT", 20.0),
            ("retry-after", "1767323055", 10.0),
            ("retry-after-ms", "1500", 1.5),
            ("x-ratelimit-reset-requests", "1s", 1.0),
            ("x-ratelimit-reset-tokens", "6m0s", 360.0),
            ("x-ratelimit-reset-requests", "20ms", 0.02),
            ("x-ratelimit-reset-tokens", "1767323060", 15.0),
            ("x-ratelimit-reset", "1767323060000", 15.0),
            ("anthropic-ratelimit-requests-reset", "2026-01-02T03:05:05Z", 60.0),
            ("anthropic-ratelimit-output-tokens-reset", "2026-01-02T03:04:06+00:00", 1.0),
        ] {
            assert_eq!(wait_s(&[(name, value)], "{}"), Some(expected), "{name}: {value}");
        }
        let info = r#"{"error":{"details":[{"@type":"type.googleapis.com/google.rpc.RetryInfo","retryDelay":"34s"}]}}"#;
        assert_eq!(wait_s(&[], info), Some(34.0));
        assert_eq!(wait_s(&[("retry-after", "soon")], ""), None);
        for (message, wanted) in [
            ("Rate limit reached on tokens per minute (TPM): Limit 6000. Please try again in 4.77s. Visit", Some(4.77)),
            ("Please try again in 1m0.5s.", Some(60.5)),
            ("Please retry in 58.5s.", Some(58.5)),
            ("Please retry after 20 seconds.", Some(20.0)),
            ("Please try again in a while.", None),
        ] {
            let body = format!("{{\"error\":{{\"message\":\"{message}\"}}}}");
            assert_eq!(wait_s(&[], &body), wanted, "{message}");
        }
    }

    #[test]
    fn the_limit_that_is_used_up_counts() {
        let headers = [
            ("x-ratelimit-remaining-requests", "0"),
            ("x-ratelimit-reset-requests", "2s"),
            ("x-ratelimit-remaining-tokens", "900"),
            ("x-ratelimit-reset-tokens", "50s"),
        ];
        assert_eq!(wait_s(&headers, ""), Some(2.0));
        let [_, rest @ ..] = headers;
        assert_eq!(wait_s(&[("x-ratelimit-remaining-requests", "5"), rest[0], rest[1], rest[2]], ""), Some(2.0));
    }

    #[test]
    fn asked_prefers_retry_after_ms_then_retry_after() {
        assert_eq!(wait_s(&[("retry-after", "9"), ("retry-after-ms", "8500")], ""), Some(8.5));
        assert_eq!(wait_s(&[("retry-after", "9"), ("x-ratelimit-reset-requests", "1m")], ""), Some(9.0));
    }

    proptest! {
        #[test]
        fn asked_reads_any_header_without_panic(value in "[ -~]{0,70}", which in 0_usize..8) {
            let (remaining, reset) = LIMIT_HEADERS[which];
            let _ = wait_s(&[("retry-after", &value), ("retry-after-ms", &value), (remaining, &value), (reset, &value)], &value);
        }
    }
}

//! The forms in which services announce how long a client should wait after a 429.

use jiff::{Timestamp, fmt::rfc2822};
use serde_json::{Value, json};
use std::time::{Duration, SystemTime};

/// How a 429 announces the wait.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum RetryAfter {
    /// Not at all.
    Silent,
    /// `retry-after: 2`, rounded up.
    Seconds,
    /// `retry-after: 0.05`.
    Decimal,
    /// `retry-after: Fri, 02 Jan 2026 03:04:05 GMT`, rounded up.
    HttpDate,
    /// `retry-after-ms: 50`.
    Milliseconds,
    /// OpenAI's `x-ratelimit-reset-requests: 50ms`; Anthropic's `anthropic-ratelimit-requests-reset` with a timestamp.
    Reset,
    /// Gemini's `RetryInfo` in the error's body. A dialect with errors that are no objects leaves it out.
    RetryInfo,
}

impl RetryAfter {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Silent, Self::Seconds, Self::Decimal, Self::HttpDate, Self::Milliseconds, Self::Reset, Self::RetryInfo];

    /// The headers that announce the wait. A dialect may have its own ones for [`Self::Reset`].
    pub(super) fn response_headers(self, wait: Duration) -> Vec<(&'static str, String)> {
        match self {
            Self::Silent | Self::RetryInfo => Vec::new(),
            Self::Seconds => vec![("retry-after", whole_seconds(wait).as_secs().to_string())],
            Self::Decimal => vec![("retry-after", format!("{:.3}", wait.as_secs_f64()))],
            Self::HttpDate => vec![("retry-after", http_date(end_of_wait(wait)))],
            Self::Milliseconds => vec![("retry-after-ms", wait.as_millis().max(1).to_string())],
            Self::Reset => vec![
                ("x-ratelimit-remaining-requests", "0".to_owned()),
                ("x-ratelimit-reset-requests", format!("{}ms", wait.as_millis().max(1))),
            ],
        }
    }

    /// The `details` in the error's body.
    pub(super) fn error_details(self, wait: Duration) -> Option<Value> {
        let delay = || format!("{:.3}s", wait.as_secs_f64());
        (self == Self::RetryInfo)
            .then(|| json!([{ "@type": "type.googleapis.com/google.rpc.RetryInfo", "retryDelay": delay() }]))
    }
}

/// A wait rounded up to whole seconds, at least one.
fn whole_seconds(wait: Duration) -> Duration {
    Duration::from_secs(wait.as_millis().div_ceil(1000).max(1).try_into().unwrap_or(u64::MAX))
}

/// The first whole second at or after the end of the wait, but at most the latest timestamp that there is.
pub(super) fn end_of_wait(wait: Duration) -> Timestamp {
    let at = Timestamp::try_from(SystemTime::now() + whole_seconds(wait + Duration::from_millis(999)));
    at.and_then(|at| Timestamp::from_second(at.as_second())).unwrap_or(Timestamp::MAX)
}

/// A moment as HTTP headers write it.
fn http_date(at: Timestamp) -> String {
    rfc2822::DateTimePrinter::new().timestamp_to_rfc9110_string(&at).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_written_in_both_ways() {
        let at = Timestamp::from_second(1_767_323_045).unwrap();
        assert_eq!(at.to_string(), "2026-01-02T03:04:05Z");
        assert_eq!(http_date(at), "Fri, 02 Jan 2026 03:04:05 GMT");
    }

    #[test]
    fn whole_seconds_are_rounded_up_and_never_none() {
        let said = |ms| RetryAfter::Seconds.response_headers(Duration::from_millis(ms))[0].1.clone();
        assert_eq!([said(0), said(50), said(1000), said(1001)], ["1", "1", "1", "2"]);
    }

    #[test]
    fn a_date_is_never_too_early() {
        let wait = Duration::from_millis(1500);
        let before = SystemTime::now();
        let said = RetryAfter::HttpDate.response_headers(wait)[0].1.clone();
        let said = rfc2822::DateTimeParser::new().parse_timestamp(&said).unwrap();
        let until = SystemTime::from(said).duration_since(before).unwrap();
        assert!(until >= wait && until <= Duration::from_secs(60), "{until:?}");
    }
}

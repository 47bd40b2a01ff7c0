//! How a service says when to come back.

use super::Dialect;
use serde_json::{Value, json};
use std::time::{Duration, SystemTime};

/// The forms in which a 429 tells how long to wait.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum RetryAfter {
    /// It does not.
    Silent,
    /// `retry-after: 2`, rounded up.
    Seconds,
    /// `retry-after: 0.05`.
    Decimal,
    /// `retry-after: Fri, 02 Jan 2026 03:04:05 GMT`, rounded up.
    HttpDate,
    /// `retry-after-ms: 50`.
    Milliseconds,
    /// OpenAI's `x-ratelimit-reset-requests: 50ms`; Anthropic's `anthropic-ratelimit-requests-reset` with a moment.
    Reset,
    /// Gemini's `RetryInfo` in the error's body; a dialect whose error is no object leaves it out.
    RetryInfo,
}

impl RetryAfter {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Silent, Self::Seconds, Self::Decimal, Self::HttpDate, Self::Milliseconds, Self::Reset, Self::RetryInfo];

    /// The headers that say it.
    pub(super) fn headers(self, wait: Duration, dialect: Dialect) -> Vec<(&'static str, String)> {
        match self {
            Self::Silent | Self::RetryInfo => Vec::new(),
            Self::Seconds => vec![("retry-after", whole_seconds(wait).as_secs().to_string())],
            Self::Decimal => vec![("retry-after", format!("{:.3}", wait.as_secs_f64()))],
            Self::HttpDate => vec![("retry-after", httpdate::fmt_http_date(moment(wait)))],
            Self::Milliseconds => vec![("retry-after-ms", wait.as_millis().max(1).to_string())],
            Self::Reset if dialect == Dialect::Anthropic => vec![
                ("anthropic-ratelimit-requests-remaining", "0".to_owned()),
                ("anthropic-ratelimit-requests-reset", rfc_3339(moment(wait))),
            ],
            Self::Reset => vec![
                ("x-ratelimit-remaining-requests", "0".to_owned()),
                ("x-ratelimit-reset-requests", format!("{}ms", wait.as_millis().max(1))),
            ],
        }
    }

    /// What stands in the error's body as `details`.
    pub(super) fn details(self, wait: Duration) -> Option<Value> {
        let delay = || format!("{:.3}s", wait.as_secs_f64());
        (self == Self::RetryInfo)
            .then(|| json!([{ "@type": "type.googleapis.com/google.rpc.RetryInfo", "retryDelay": delay() }]))
    }
}

fn whole_seconds(wait: Duration) -> Duration {
    Duration::from_secs(wait.as_millis().div_ceil(1000).max(1).try_into().unwrap_or(u64::MAX))
}

/// The first whole second that is no sooner than the wait.
fn moment(wait: Duration) -> SystemTime {
    SystemTime::now() + whole_seconds(wait + Duration::from_millis(999))
}

/// A moment as RFC 3339 has it, from the date that HTTP writes.
fn rfc_3339(at: SystemTime) -> String {
    let http = httpdate::fmt_http_date(at);
    let parts: Vec<&str> = http.split(' ').collect();
    let [_, day, month, year, time, _] = parts.as_slice() else { return http };
    let months = "JanFebMarAprMayJunJulAugSepOctNovDec";
    let month = months.find(month).map_or(1, |at| at / 3 + 1);
    format!("{year}-{month:02}-{day}T{time}Z")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_written_in_both_ways() {
        let at = SystemTime::UNIX_EPOCH + Duration::from_secs(1_767_323_045);
        assert_eq!(rfc_3339(at), "2026-01-02T03:04:05Z");
    }

    #[test]
    fn whole_seconds_are_rounded_up_and_never_none() {
        let said = |ms| RetryAfter::Seconds.headers(Duration::from_millis(ms), Dialect::OpenAi)[0].1.clone();
        assert_eq!([said(0), said(50), said(1000), said(1001)], ["1", "1", "1", "2"]);
    }

    #[test]
    fn a_date_is_never_too_early() {
        let wait = Duration::from_millis(1500);
        let before = SystemTime::now();
        let said = RetryAfter::HttpDate.headers(wait, Dialect::OpenAi)[0].1.clone();
        let until = httpdate::parse_http_date(&said).unwrap().duration_since(before).unwrap();
        assert!(until >= wait && until <= Duration::from_secs(60), "{until:?}");
    }
}

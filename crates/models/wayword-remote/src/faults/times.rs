//! Parses times and dates in the forms that services use in headers and bodies.

use jiff::{
    SpanRelativeTo, Timestamp,
    fmt::{friendly::SpanParser, rfc2822::DateTimeParser},
};
use std::time::{Duration, SystemTime};

/// Longest text that is read as a time, bytes. A longer one is no time.
const MAX_TIME_TEXT_BYTES: usize = 64;

/// Longest time, a year. Longer ones count as this.
const MAX_READ_DURATION: Duration = Duration::from_secs(366 * 24 * 60 * 60);

/// A length of time with units (`1s`, `6m0s`, `20ms`, `1h2m3.5s`).
pub(super) fn parse_duration(text: &str) -> Option<Duration> {
    let text = trimmed_text(text)?;
    // The parser also reads spaces, signs and "ago", which no service sends.
    let plain = text.chars().all(|c| c.is_alphanumeric() || c == '.');
    let span = plain.then(|| SpanParser::new().parse_span(text).ok()).flatten()?;
    let length = span.to_duration(SpanRelativeTo::days_are_24_hours()).ok()?;
    Duration::try_from(length).ok().map(|length| length.min(MAX_READ_DURATION))
}

/// A bare number of seconds, whole or not.
pub(super) fn bare_seconds(text: &str) -> Option<Duration> {
    let text = trimmed_text(text)?;
    let plain = text.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    let s: f64 = plain.then(|| text.parse().ok()).flatten()?;
    Some(Duration::from_secs_f64(s.min(MAX_READ_DURATION.as_secs_f64())))
}

/// The time until an HTTP date (RFC 9110, section 5.6.7). The two obsolete forms are not read, because no service is
/// known to send them; then the program chooses the wait.
pub(super) fn until_http_date(text: &str, now: SystemTime) -> Option<Duration> {
    let at = DateTimeParser::new().relaxed_weekday(true).parse_timestamp(trimmed_text(text)?).ok()?;
    Some(time_until(at.into(), now))
}

/// The time until a date of RFC 3339.
pub(super) fn until_rfc_3339(text: &str, now: SystemTime) -> Option<Duration> {
    let at: Timestamp = trimmed_text(text)?.parse().ok()?;
    Some(time_until(at.into(), now))
}

/// The time until a number of seconds, or milliseconds, since 1970.
pub(super) fn until_unix(text: &str, now: SystemTime) -> Option<Duration> {
    let number: f64 = text.trim().parse().ok()?;
    // Seconds since 1970 exceed 1e12 only in the year 33658, so a larger number is in milliseconds.
    let s = if number > 1e12 { number / 1000.0 } else { number };
    if !(1e9..1e11).contains(&s) {
        return None;
    }
    Some(time_until(SystemTime::UNIX_EPOCH.checked_add(Duration::from_secs_f64(s))?, now))
}

/// The time until a moment; 0 if the moment is past.
fn time_until(at: SystemTime, now: SystemTime) -> Duration {
    at.duration_since(now).unwrap_or_default()
}

/// A text without white space around it; `None` if it is too long for a time.
fn trimmed_text(text: &str) -> Option<&str> {
    Some(text.trim()).filter(|text| text.len() <= MAX_TIME_TEXT_BYTES)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn at(s: u64) -> SystemTime {
        SystemTime::UNIX_EPOCH + Duration::from_secs(s)
    }

    #[test]
    fn lengths_of_time() {
        let s = |text| parse_duration(text).map(|d| d.as_secs_f64());
        assert_eq!(s("1s"), Some(1.0));
        assert_eq!(s("6m0s"), Some(360.0));
        assert_eq!(s("20ms"), Some(0.02));
        assert_eq!(s("1h2m3.5s"), Some(3723.5));
        assert_eq!(s("34s"), Some(34.0));
        for text in ["", "s", "1", "1x", "-1s", "1..2s", "1 s", "9".repeat(70).as_str()] {
            assert_eq!(parse_duration(text), None, "{text}");
        }
    }

    #[test]
    fn moments() {
        // 2026-01-02T03:04:05Z
        let moment = 1_767_323_045;
        let now = at(moment - 90);
        let ninety = Some(Duration::from_secs(90));
        assert_eq!(until_rfc_3339("2026-01-02T03:04:05Z", now), ninety);
        assert_eq!(until_rfc_3339("2026-01-02T05:04:05+02:00", now), ninety);
        assert_eq!(until_http_date("Fri, 02 Jan 2026 03:04:05 GMT", now), ninety);
        assert_eq!(until_unix("1767323045", now), ninety);
        assert_eq!(until_unix("1767323045000", now), ninety);
        assert_eq!(until_rfc_3339("2025-01-02T03:04:05Z", now), Some(Duration::ZERO));
        assert_eq!(until_rfc_3339("2026-01-02", now), None);
        assert_eq!(until_unix("12", now), None);
    }

    #[test]
    fn bare_numbers() {
        assert_eq!(bare_seconds("2"), Some(Duration::from_secs(2)));
        assert_eq!(bare_seconds(" 0.25 "), Some(Duration::from_millis(250)));
        for text in ["", "-1", "1e9", "inf", "NaN", "."] {
            assert_eq!(bare_seconds(text), None, "{text}");
        }
    }

    proptest! {
        #[test]
        fn times_are_read_from_any_text_without_panic(text in ".{0,80}", s in 0_u64..4_000_000_000) {
            let now = at(s);
            let (duration, bare) = (parse_duration(&text), bare_seconds(&text));
            prop_assert!(duration.or(bare).is_none_or(|d| d <= MAX_READ_DURATION));
            let _ = (until_http_date(&text, now), until_rfc_3339(&text, now), until_unix(&text, now));
        }

        #[test]
        fn times_in_the_forms_of_services_are_read(h in 0_u32..20, m in 0_u32..60, s in 0_u32..60, ms in 0_u32..1000) {
            let text = format!("{h}h{m}m{s}s{ms}ms");
            let expected = f64::from(h * 3600 + m * 60 + s) + f64::from(ms) / 1000.0;
            prop_assert!((parse_duration(&text).unwrap().as_secs_f64() - expected).abs() < 1e-6);
        }

        #[test]
        fn dates_are_where_the_http_dates_are(s in 0_u64..4_000_000_000, early in 0_u64..1_000_000) {
            let now = at(s.saturating_sub(early));
            let at = Timestamp::from_second(s as i64).unwrap();
            let text = jiff::fmt::rfc2822::DateTimePrinter::new().timestamp_to_rfc9110_string(&at).unwrap();
            prop_assert_eq!(until_http_date(&text, now).unwrap(), SystemTime::from(at).duration_since(now).unwrap());
        }
    }
}

//! Times as services write them.

use std::time::{Duration, SystemTime};
use toml::value::{Datetime, Offset};

/// Longest text that is taken for a time.
const LONGEST: usize = 64;

/// Largest time that is told apart from a larger one, seconds: a year.
const MOST_S: f64 = 366.0 * 86_400.0;

/// A length of time with units (`1s`, `6m0s`, `20ms`, `1h2m3.5s`).
pub(super) fn duration(text: &str) -> Option<Duration> {
    let mut rest = text.trim();
    if rest.is_empty() || rest.len() > LONGEST {
        return None;
    }
    let mut total_s = 0.0;
    while !rest.is_empty() {
        let end = rest.find(|c: char| !c.is_ascii_digit() && c != '.')?;
        let (number, tail) = rest.split_at(end);
        let unit_end = tail.find(|c: char| c.is_ascii_digit() || c == '.').unwrap_or(tail.len());
        let (unit, tail) = tail.split_at(unit_end);
        let unit_s = match unit {
            "ns" => 1e-9,
            "us" | "µs" => 1e-6,
            "ms" => 1e-3,
            "s" => 1.0,
            "m" => 60.0,
            "h" => 3600.0,
            "d" => 86_400.0,
            _ => return None,
        };
        total_s += number.parse::<f64>().ok()? * unit_s;
        rest = tail;
    }
    seconds(total_s)
}

/// A bare number of seconds, whole or not.
pub(super) fn bare_seconds(text: &str) -> Option<Duration> {
    let text = text.trim();
    let plain =
        !text.is_empty() && text.len() <= LONGEST && text.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    seconds(plain.then(|| text.parse().ok()).flatten()?)
}

/// How long it is until a moment that is written as an HTTP date.
pub(super) fn until_http_date(text: &str, now: SystemTime) -> Option<Duration> {
    let at = (text.len() <= LONGEST).then(|| httpdate::parse_http_date(text.trim()).ok()).flatten()?;
    Some(until(at, now))
}

/// How long it is until a moment that is written as RFC 3339 has it.
pub(super) fn until_rfc_3339(text: &str, now: SystemTime) -> Option<Duration> {
    let at: Datetime = (text.len() <= LONGEST).then(|| text.trim().parse().ok()).flatten()?;
    let (date, time) = (at.date?, at.time?);
    let offset_min = match at.offset? {
        Offset::Z => 0,
        Offset::Custom { minutes } => i64::from(minutes),
    };
    let days = days_from_civil(i64::from(date.year), i64::from(date.month), i64::from(date.day));
    let minutes = days * 1440 + i64::from(time.hour) * 60 + i64::from(time.minute) - offset_min;
    let seconds = u64::try_from(minutes * 60 + i64::from(time.second)).ok()?;
    let nanos = time.nanosecond.min(999_999_999);
    Some(until(SystemTime::UNIX_EPOCH.checked_add(Duration::new(seconds, nanos))?, now))
}

/// How long it is until a moment that is a number of seconds, or milliseconds, since 1970.
pub(super) fn until_unix(text: &str, now: SystemTime) -> Option<Duration> {
    let number: f64 = text.trim().parse().ok()?;
    let s = if number > 1e12 { number / 1000.0 } else { number };
    if !(1e9..1e11).contains(&s) {
        return None;
    }
    Some(until(SystemTime::UNIX_EPOCH.checked_add(Duration::from_secs_f64(s))?, now))
}

/// Nothing for a moment that is past.
fn until(at: SystemTime, now: SystemTime) -> Duration {
    at.duration_since(now).unwrap_or_default()
}

fn seconds(s: f64) -> Option<Duration> {
    s.is_finite().then(|| Duration::from_secs_f64(s.clamp(0.0, MOST_S)))
}

/// Days since 1970-01-01 (Howard Hinnant, "chrono-Compatible Low-Level Date Algorithms").
fn days_from_civil(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let era = year.div_euclid(400);
    let of_era = year.rem_euclid(400);
    let of_year = (153 * (month + if month > 2 { -3 } else { 9 }) + 2) / 5 + day - 1;
    era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468
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
        let s = |text| duration(text).map(|d| d.as_secs_f64());
        assert_eq!(s("1s"), Some(1.0));
        assert_eq!(s("6m0s"), Some(360.0));
        assert_eq!(s("20ms"), Some(0.02));
        assert_eq!(s("1h2m3.5s"), Some(3723.5));
        assert_eq!(s("34s"), Some(34.0));
        for text in ["", "s", "1", "1x", "-1s", "1..2s", "1 s", "9".repeat(70).as_str()] {
            assert_eq!(duration(text), None, "{text}");
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
        fn no_text_is_too_odd(text in ".{0,80}", s in 0_u64..4_000_000_000) {
            let now = at(s);
            let (duration, bare) = (duration(&text), bare_seconds(&text));
            prop_assert!(duration.or(bare).is_none_or(|d| d.as_secs_f64() <= MOST_S));
            let _ = (until_http_date(&text, now), until_rfc_3339(&text, now), until_unix(&text, now));
        }

        #[test]
        fn what_a_service_writes_is_read(h in 0_u32..20, m in 0_u32..60, s in 0_u32..60, ms in 0_u32..1000) {
            let text = format!("{h}h{m}m{s}s{ms}ms");
            let expected = f64::from(h * 3600 + m * 60 + s) + f64::from(ms) / 1000.0;
            prop_assert!((duration(&text).unwrap().as_secs_f64() - expected).abs() < 1e-6);
        }

        #[test]
        fn dates_are_where_the_http_dates_are(s in 0_u64..4_000_000_000, early in 0_u64..1_000_000) {
            let now = at(s.saturating_sub(early));
            let text = httpdate::fmt_http_date(at(s));
            let parsed = httpdate::parse_http_date(&text).unwrap();
            prop_assert_eq!(until_http_date(&text, now).unwrap(), parsed.duration_since(now).unwrap());
        }
    }
}

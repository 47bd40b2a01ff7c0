//! Guards every request: sets security headers, refuses forms from other sites, and limits how fast a participant may ask.

use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, header};
use std::{
    collections::{HashMap, HashSet},
    sync::{Mutex, PoisonError},
    time::Instant,
};

/// Limit for a participant's requests: a burst, and a number for each second after that.
const PERSON_PACE: RequestPace = RequestPace { at_once: 120.0, each_second: 20.0 };
/// Limit for a participant's pictures. It is higher, because a page without script loads a whole film at once.
const PICTURE_PACE: RequestPace = RequestPace { at_once: 600.0, each_second: 60.0 };
/// Limit for the requests of all visitors without a session together.
const STRANGER_PACE: RequestPace = RequestPace { at_once: 600.0, each_second: 100.0 };
/// Most entries in each table of the limiter, so that its memory is bounded. Beyond it, full buckets and all known sessions are
/// forgotten; both come back with the next request.
const MAX_REMEMBERED_PARTICIPANTS: usize = 20_000;

/// Content security policy: a page loads nothing from other sites, runs no inline script, and cannot be embedded in another page.
const PAGE_SECURITY_POLICY: &str = "default-src 'none'; img-src 'self'; style-src 'self'; script-src 'self'; connect-src 'self'; form-action 'self'; \
                      base-uri 'none'; frame-ancestors 'none'";

/// The headers of every response.
pub(super) fn response_headers(is_secure: bool) -> Vec<(HeaderName, HeaderValue)> {
    let mut all = vec![
        (header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(PAGE_SECURITY_POLICY)),
        (header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff")),
        // The address by which a participant came identifies the participant, so no other site may get it. Not `no-referrer`: with
        // that, browsers send forms without an origin.
        (header::REFERRER_POLICY, HeaderValue::from_static("same-origin")),
        (header::X_FRAME_OPTIONS, HeaderValue::from_static("DENY")),
        (header::CACHE_CONTROL, HeaderValue::from_static("no-store")),
        (HeaderName::from_static("cross-origin-opener-policy"), HeaderValue::from_static("same-origin")),
        (HeaderName::from_static("cross-origin-resource-policy"), HeaderValue::from_static("same-origin")),
        (
            HeaderName::from_static("permissions-policy"),
            HeaderValue::from_static("camera=(), microphone=(), geolocation=(), browsing-topics=()"),
        ),
    ];
    if is_secure {
        all.push((header::STRICT_TRANSPORT_SECURITY, HeaderValue::from_static("max-age=31536000")));
    }
    all
}

/// Whether a form comes from a page of this site. Scripts on other sites cannot forge these headers, because the browser sets them.
pub(super) fn comes_from_this_site(headers: &HeaderMap, public: Option<&str>, scheme: &str) -> bool {
    let header_text = |name: HeaderName| headers.get(name).and_then(|value| value.to_str().ok());
    match (header_text(header::ORIGIN), header_text(header::HOST)) {
        (Some(origin), host) => {
            public.is_some_and(|public| origin == public)
                || host.is_some_and(|host| origin == format!("{scheme}://{host}"))
        }
        (None, _) => header_text(HeaderName::from_static("sec-fetch-site")) == Some("same-origin"),
    }
}

/// Whether a request with this method changes something.
pub(super) fn changes_state(method: &Method) -> bool {
    !matches!(*method, Method::GET | Method::HEAD)
}

/// The sender of a request, for the rate limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum RequestSource {
    /// A participant.
    Person(i64),
    /// A participant's pictures.
    Pictures(i64),
    /// All visitors without a session together.
    Stranger,
}

impl RequestSource {
    fn allowed_rate(self) -> RequestPace {
        match self {
            Self::Person(_) => PERSON_PACE,
            Self::Pictures(_) => PICTURE_PACE,
            Self::Stranger => STRANGER_PACE,
        }
    }
}

/// A rate limit: the size of a burst, and the requests per second.
#[derive(Debug, Clone, Copy)]
struct RequestPace {
    at_once: f64,
    each_second: f64,
}

/// Limits how fast each participant asks, by the token bucket algorithm: each request takes a token from the participant's bucket, and
/// the bucket refills at a constant rate. It goes by participant and not by network address, which a whole university may share.
#[derive(Debug)]
pub(super) struct RequestLimiter {
    /// The time from which the times of the buckets count.
    began: Instant,
    buckets: Mutex<HashMap<RequestSource, RequestBucket>>,
    /// Tokens of sessions that were valid before.
    known_sessions: Mutex<HashSet<String>>,
}

#[derive(Debug, Clone, Copy)]
struct RequestBucket {
    /// Tokens in the bucket.
    tokens: f64,
    /// When it was last refilled, seconds after the limiter began.
    at_s: f64,
}

impl RequestLimiter {
    pub(super) fn new() -> Self {
        Self { began: Instant::now(), buckets: Mutex::default(), known_sessions: Mutex::default() }
    }

    /// Whether a session was valid before.
    pub(super) fn knows_session(&self, session: &str) -> bool {
        self.known_sessions.lock().unwrap_or_else(PoisonError::into_inner).contains(session)
    }

    /// Remembers a valid session.
    pub(super) fn remember_session(&self, session: String) {
        let mut known = self.known_sessions.lock().unwrap_or_else(PoisonError::into_inner);
        if known.len() >= MAX_REMEMBERED_PARTICIPANTS {
            known.clear();
        }
        known.insert(session);
    }

    /// Whether a request is allowed now. If so, it uses up one token.
    pub(super) fn allows_request(&self, asker: RequestSource) -> bool {
        self.allows_at(asker, self.began.elapsed().as_secs_f64())
    }

    /// Whether a request is allowed at a time, in seconds after the limiter began.
    fn allows_at(&self, asker: RequestSource, now_s: f64) -> bool {
        let rate = asker.allowed_rate();
        let mut buckets = self.buckets.lock().unwrap_or_else(PoisonError::into_inner);
        if buckets.len() >= MAX_REMEMBERED_PARTICIPANTS {
            // A bucket that has had the time to fill up again need not be remembered. Those for pictures take longest.
            let full_after_s = PICTURE_PACE.at_once / PICTURE_PACE.each_second;
            buckets.retain(|_, bucket| now_s - bucket.at_s < full_after_s);
        }
        let bucket = buckets.entry(asker).or_insert(RequestBucket { tokens: rate.at_once, at_s: now_s });
        bucket.tokens = (bucket.tokens + (now_s - bucket.at_s) * rate.each_second).min(rate.at_once);
        bucket.at_s = now_s;
        let is_allowed = bucket.tokens >= 1.0;
        if is_allowed {
            bucket.tokens -= 1.0;
        }
        is_allowed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn from(pairs: &[(&'static str, &str)]) -> HeaderMap {
        pairs
            .iter()
            .map(|(name, value)| (HeaderName::from_static(name), HeaderValue::from_str(value).unwrap()))
            .collect()
    }

    #[test]
    fn a_form_of_another_site_is_refused() {
        let own = |pairs: &[(&'static str, &str)]| {
            comes_from_this_site(&from(pairs), Some("https://study.example.org"), "http")
        };
        assert!(own(&[("origin", "http://127.0.0.1:8080"), ("host", "127.0.0.1:8080")]));
        assert!(own(&[("origin", "https://study.example.org"), ("host", "127.0.0.1:8080")]));
        assert!(own(&[("sec-fetch-site", "same-origin")]));
        assert!(!own(&[("origin", "https://evil.example"), ("host", "127.0.0.1:8080")]));
        assert!(!own(&[("origin", "null"), ("sec-fetch-site", "same-origin"), ("host", "127.0.0.1:8080")]));
        assert!(!own(&[("host", "127.0.0.1:8080")]));
        assert!(!own(&[("sec-fetch-site", "cross-site")]));
    }

    #[test]
    fn who_asks_too_fast_waits_and_nobody_else_does() {
        let pace = RequestLimiter::new();
        let asked = (0..200).filter(|_| pace.allows_at(RequestSource::Person(1), 0.0)).count();
        assert_eq!(asked, 120);
        assert!(pace.allows_at(RequestSource::Person(2), 0.0) && pace.allows_at(RequestSource::Stranger, 0.0));
        assert_eq!((0..200).filter(|_| pace.allows_at(RequestSource::Person(1), 1.0)).count(), 20);
    }

    #[test]
    fn over_tls_browsers_come_back_over_tls() {
        let has =
            |is_secure| response_headers(is_secure).iter().any(|(name, _)| *name == header::STRICT_TRANSPORT_SECURITY);
        assert!(has(true) && !has(false));
    }

    #[test]
    fn memory_of_the_pace_is_bounded() {
        let pace = RequestLimiter::new();
        for person in 0..100_000 {
            pace.allows_at(RequestSource::Person(person), f64::from(u32::try_from(person).unwrap()));
        }
        assert!(pace.buckets.lock().unwrap().len() <= MAX_REMEMBERED_PARTICIPANTS);
    }
}

//! The two cookies of the site: the session of a participant, and, before the consent, the link by which the visitor came.

use crate::store::ParticipantArrival;
use axum::http::{HeaderMap, HeaderValue, header};
use base64::{Engine as _, engine::general_purpose::URL_SAFE_NO_PAD};

/// Longest cookie value that is read, bytes. Longer ones are ignored.
const MAX_COOKIE_BYTES: usize = 1024;

/// Reads and writes the cookies.
#[derive(Debug, Clone, Copy)]
pub(super) struct StudyCookies {
    /// Whether browsers reach the site over TLS.
    pub(super) is_secure: bool,
}

impl StudyCookies {
    fn cookie_name(self, base_name: &'static str) -> String {
        // A browser takes a `__Host-` cookie only from the host itself, over TLS.
        if self.is_secure { format!("__Host-{base_name}") } else { base_name.to_owned() }
    }

    /// The session's token.
    pub(super) fn session_token(self, headers: &HeaderMap) -> Option<String> {
        cookie_value(headers, &self.cookie_name("session"))
    }

    /// The link by which the visitor came, from the cookie.
    pub(super) fn pending_arrival(self, headers: &HeaderMap) -> Option<ParticipantArrival> {
        let bytes = URL_SAFE_NO_PAD.decode(cookie_value(headers, &self.cookie_name("arrival"))?).ok()?;
        serde_json::from_slice(&bytes).ok()
    }

    /// Sets the session's token for 7 days. It outlives the browser, so that a participant can go on tomorrow.
    pub(super) fn set_session(self, token: &str) -> Option<HeaderValue> {
        self.cookie_header("session", token, "; Max-Age=604800")
    }

    /// Stores the link by which the visitor came, for the hour in which they read and consent.
    pub(super) fn set_arrival(self, arrival: &ParticipantArrival) -> Option<HeaderValue> {
        let json = serde_json::to_vec(arrival).ok()?;
        self.cookie_header("arrival", &URL_SAFE_NO_PAD.encode(json), "; Max-Age=3600")
    }

    /// Removes the arrival cookie.
    pub(super) fn drop_arrival(self) -> Option<HeaderValue> {
        self.cookie_header("arrival", "", "; Max-Age=0")
    }

    /// Removes the session cookie.
    pub(super) fn drop_session(self) -> Option<HeaderValue> {
        self.cookie_header("session", "", "; Max-Age=0")
    }

    fn cookie_header(self, base_name: &'static str, value: &str, age: &str) -> Option<HeaderValue> {
        let secure = if self.is_secure { "; Secure" } else { "" };
        // Lax, not Strict: a recruiter's link comes from another site, and must find the session.
        let text = format!("{}={value}; Path=/; HttpOnly; SameSite=Lax{secure}{age}", self.cookie_name(base_name));
        HeaderValue::from_str(&text).ok()
    }
}

/// The value of a cookie, unless it is empty or too long. A request may have several cookie lines with several pairs each.
fn cookie_value(headers: &HeaderMap, name: &str) -> Option<String> {
    let lines = headers.get_all(header::COOKIE).iter().filter_map(|line| line.to_str().ok());
    let pairs = lines.flat_map(|line| line.split(';')).filter_map(|pair| pair.trim().split_once('='));
    let mut values = pairs.filter(|(key, _)| *key == name).map(|(_, value)| value);
    values.next().filter(|value| !value.is_empty() && value.len() <= MAX_COOKIE_BYTES).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sent(text: &str) -> HeaderMap {
        HeaderMap::from_iter([(header::COOKIE, HeaderValue::from_str(text).unwrap())])
    }

    #[test]
    fn what_was_set_is_read() {
        let cookies = StudyCookies { is_secure: true };
        let arrival = ParticipantArrival::Recruit { person: "p".into(), study: "s".into(), session: "x".into() };
        let set = cookies.set_arrival(&arrival).unwrap();
        let set = set.to_str().unwrap();
        assert!(
            set.starts_with("__Host-arrival=") && set.contains("; Path=/; HttpOnly; SameSite=Lax; Secure;"),
            "{set}"
        );
        let pair = set.split(';').next().unwrap();
        assert_eq!(cookies.pending_arrival(&sent(&format!("a=b; {pair}"))), Some(arrival));
        assert_eq!(StudyCookies { is_secure: false }.pending_arrival(&sent(pair)), None);
    }

    #[test]
    fn malformed_and_oversized_cookies_are_ignored() {
        let cookies = StudyCookies { is_secure: false };
        for text in ["", "session=", "session", "x=y; =; ;;", "arrival=%%%"] {
            assert_eq!(
                (cookies.session_token(&sent(text)), cookies.pending_arrival(&sent(text))),
                (None, None),
                "{text}"
            );
        }
        assert_eq!(cookies.session_token(&sent(&format!("session={}", "a".repeat(MAX_COOKIE_BYTES + 1)))), None);
    }
}

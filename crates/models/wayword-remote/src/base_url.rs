//! Parses and checks a provider's base URL.

use std::{fmt, net::IpAddr};
use ureq::http::Uri;

/// The longest base URL, bytes. A longer one is refused.
const MAX_URL_BYTES: usize = 2000;

/// A checked base URL: `http` or `https`, a host, and optionally a path. No password, no query, no slash at the end.
#[derive(Clone, PartialEq, Eq)]
pub(crate) struct BaseUrl {
    text: String,
    /// Whether the host is this machine.
    pub(crate) loopback: bool,
    /// Whether the scheme is `http`, so that others on the network can read the requests.
    pub(crate) plain: bool,
}

impl BaseUrl {
    /// Reads a base URL. If it has no path, adds the version that the dialect uses.
    ///
    /// # Errors
    /// The message names the problem and leaves out the URL, because it may contain a password.
    pub(crate) fn new(text: &str, version: &str) -> Result<Self, &'static str> {
        if text.len() > MAX_URL_BYTES {
            return Err("is too long");
        }
        let uri: Uri = text.trim().parse().map_err(|_| "is not a URL")?;
        let plain = match uri.scheme_str() {
            Some("http") => true,
            Some("https") => false,
            _ => return Err("begins with neither http:// nor https://"),
        };
        let authority = uri.authority().ok_or("has no host")?;
        if authority.as_str().contains('@') {
            return Err("contains a user or a password: put keys into environment variables");
        }
        if uri.query().is_some() || text.contains('#') {
            return Err("contains more than a host and a path");
        }
        let host = uri.host().filter(|host| !host.is_empty()).ok_or("has no host")?;
        let path = uri.path().trim_end_matches('/');
        let path = if path.is_empty() { version } else { path };
        let scheme = if plain { "http" } else { "https" };
        Ok(Self { text: format!("{scheme}://{authority}{path}"), loopback: is_loopback(host), plain })
    }

    /// The whole URL.
    pub(crate) fn as_str(&self) -> &str {
        &self.text
    }

    /// The URL with `path` added, which begins with a slash.
    pub(crate) fn with_path(&self, path: &str) -> String {
        format!("{}{path}", self.text)
    }
}

/// Whether a host is this machine.
fn is_loopback(host: &str) -> bool {
    let bare = host.trim_start_matches('[').trim_end_matches(']');
    bare.eq_ignore_ascii_case("localhost") || bare.parse().is_ok_and(|address: IpAddr| address.is_loopback())
}

impl fmt::Debug for BaseUrl {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_server_is_a_scheme_a_host_and_perhaps_a_path() {
        let url = BaseUrl::new("http://127.0.0.1:8000/v1/", "").unwrap();
        assert_eq!(url.with_path("/models"), "http://127.0.0.1:8000/v1/models");
        assert!(url.loopback && url.plain);
        let url = BaseUrl::new("https://api.anthropic.com", "/v1").unwrap();
        assert_eq!(url.as_str(), "https://api.anthropic.com/v1");
        assert!(!url.loopback && !url.plain);
        assert!(BaseUrl::new("http://[::1]:80", "").unwrap().loopback);
    }

    #[test]
    fn a_password_is_refused_and_not_repeated() {
        let problem = BaseUrl::new("https://me:hunter2@host/v1", "").unwrap_err();
        assert!(problem.contains("password") && !problem.contains("hunter2"));
    }

    #[test]
    fn new_refuses_texts_that_are_no_web_address() {
        for text in
            ["", "localhost:8000", "ftp://host/", "file:///etc/passwd", "http://", "http://h/v1?key=1", "http://h/#x"]
        {
            assert!(BaseUrl::new(text, "").is_err(), "{text}");
        }
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in ".{0,60}") {
            let _ = BaseUrl::new(&text, "/v1");
        }
    }
}

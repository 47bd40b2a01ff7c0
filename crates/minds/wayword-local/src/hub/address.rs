//! Web addresses of the hub and of where it sends us.

use super::name::OnHub;
use std::{fmt::Write, net::IpAddr};
use ureq::http::Uri;

/// `http` or `https`, a host, a path.
#[derive(Debug, Clone)]
pub(super) struct Address {
    text: String,
    uri: Uri,
}

impl Address {
    /// Reads an address.
    ///
    /// # Errors
    /// Says what is wrong without the address: it may hold a password or a signature.
    pub(super) fn parse(text: &str) -> Result<Self, &'static str> {
        let uri: Uri = text.parse().map_err(|_| "it is no web address")?;
        let authority = uri.authority().ok_or("it has no host")?;
        if !matches!(uri.scheme_str(), Some("http" | "https")) {
            return Err("it begins with neither http:// nor https://");
        }
        if authority.as_str().contains('@') || authority.host().is_empty() {
            return Err("it holds a user or a password, or no host");
        }
        Ok(Self { text: text.to_owned(), uri })
    }

    /// The hub's address, to which a file's path is added.
    pub(super) fn endpoint(text: &str) -> Result<Self, &'static str> {
        let address = Self::parse(text.trim().trim_end_matches('/'))?;
        if address.uri.query().is_some() || text.contains('#') {
            return Err("it holds more than a host and a path");
        }
        Ok(address)
    }

    /// The address of a file below the hub's.
    pub(super) fn resolve(&self, place: &OnHub, revision: &str, file: &str) -> String {
        let OnHub { org, name, .. } = place;
        // A revision is one segment, a file may be several.
        format!("{}/{org}/{name}/resolve/{}/{}", self.text, encoded(revision, ""), encoded(file, "/"))
    }

    /// Where a redirect leads.
    pub(super) fn redirected(&self, location: &str) -> Result<Self, &'static str> {
        let (scheme, host, port) = self.origin();
        let to = if location.starts_with("//") {
            Self::parse(&format!("{scheme}:{location}"))?
        } else if location.starts_with('/') {
            Self::parse(&format!("{scheme}://{host}:{port}{location}"))?
        } else {
            Self::parse(location)?
        };
        if to.is_plain() && !self.is_plain() { Err("it leads from https to http") } else { Ok(to) }
    }

    pub(super) fn as_str(&self) -> &str {
        &self.text
    }

    pub(super) fn host(&self) -> &str {
        self.uri.host().unwrap_or_default()
    }

    /// Scheme, host and port: who is spoken to.
    pub(super) fn origin(&self) -> (&str, String, u16) {
        let scheme = self.uri.scheme_str().unwrap_or_default();
        let port = self.uri.port_u16().unwrap_or(if self.is_plain() { 80 } else { 443 });
        (scheme, self.host().to_ascii_lowercase(), port)
    }

    /// Whether others on the way can read what is sent.
    fn is_plain(&self) -> bool {
        self.uri.scheme_str() != Some("https")
    }

    /// Whether it is this machine.
    pub(super) fn is_loopback(&self) -> bool {
        let bare = self.host().trim_start_matches('[').trim_end_matches(']');
        bare.eq_ignore_ascii_case("localhost") || bare.parse().is_ok_and(|address: IpAddr| address.is_loopback())
    }

    /// Whether a token may go there: nobody on the way can read it.
    pub(super) fn keeps_secrets(&self) -> bool {
        !self.is_plain() || self.is_loopback()
    }
}

/// Percent-encodes everything but what every address may hold, and `also`.
fn encoded(text: &str, also: &str) -> String {
    text.bytes().fold(String::new(), |mut encoded, byte| {
        let c = char::from(byte);
        if byte.is_ascii_alphanumeric() || "-_.~".contains(c) || also.contains(c) {
            encoded.push(c);
        } else {
            // Writing to a string cannot fail.
            let _ = write!(encoded, "%{byte:02X}");
        }
        encoded
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place() -> OnHub {
        OnHub { org: "org".into(), name: "name".into(), revision: "main".into(), file: None }
    }

    #[test]
    fn revisions_and_files_are_encoded() {
        let hub = Address::endpoint("https://huggingface.co/").unwrap();
        assert_eq!(
            hub.resolve(&place(), "refs/pr/1", "a/b+c.gguf"),
            "https://huggingface.co/org/name/resolve/refs%2Fpr%2F1/a/b%2Bc.gguf"
        );
    }

    #[test]
    fn redirects_lead_within_the_host_or_elsewhere_but_never_from_https_to_http() {
        let from = Address::parse("https://hub.example/a/b?c=d").unwrap();
        assert_eq!(from.redirected("/x?y=z").unwrap().as_str(), "https://hub.example:443/x?y=z");
        assert_eq!(from.redirected("/x").unwrap().origin(), from.origin());
        assert_eq!(from.redirected("//other.example/x").unwrap().origin().1, "other.example");
        assert_ne!(from.redirected("https://hub.example:8443/").unwrap().origin(), from.origin());
        for location in ["http://hub.example/", "ftp://hub.example/", "x", "", "https://u:p@hub.example/", "//"] {
            assert!(from.redirected(location).is_err(), "{location}");
        }
    }

    #[test]
    fn an_endpoint_that_is_none_is_not_repeated() {
        for text in ["", "huggingface.co", "https://me:hunter2@host", "https://host/?q", "https://host/#x", "http://"] {
            let problem = Address::endpoint(text).unwrap_err();
            assert!(!problem.contains("hunter2"));
        }
    }
}

//! What a status of the hub means, and what to do about it.

use super::{name::OnHub, trouble::Trouble};
use crate::LocalError;
use std::time::Duration;
use ureq::http::HeaderMap;

/// A request that was answered with an error.
pub(super) struct Refused<'a> {
    pub(super) status: u16,
    pub(super) headers: &'a HeaderMap,
    pub(super) address: &'a str,
    pub(super) place: &'a OnHub,
    /// Whether a token was sent along.
    pub(super) had_token: bool,
}

/// The hub's own word for what is wrong.
fn code(headers: &HeaderMap) -> &str {
    headers.get("x-error-code").and_then(|value| value.to_str().ok()).unwrap_or("")
}

/// Whether the model is there and lacks the file, which may be no error.
pub(super) fn is_absence(status: u16, headers: &HeaderMap) -> bool {
    status == 404 && !["RepoNotFound", "RevisionNotFound"].contains(&code(headers))
}

impl Refused<'_> {
    pub(super) fn trouble(&self) -> Trouble {
        let Self { status, place, .. } = self;
        if matches!(status, 408 | 429 | 500..=599) {
            return Trouble::Passing { problem: format!("the server answers with status {status}"), wait: self.wait() };
        }
        let name = format!("{}/{}", place.org, place.name);
        let (problem, hint) = match (status, code(self.headers)) {
            (401 | 403, "GatedRepo") => (
                format!("{name} is gated: its authors give it to whom they have let in"),
                format!("accept its terms on the page of {name}, and put a token that may read it into HF_TOKEN"),
            ),
            (404, "RevisionNotFound") => (
                format!("{name} has no revision {}", place.revision),
                "see the branches, tags and commits on the hub's page of the model".to_owned(),
            ),
            (401 | 403, _) if self.had_token => (
                format!("the token in HF_TOKEN does not open {name} (status {status})"),
                "see that the name is right, and that the token is valid and may read it".to_owned(),
            ),
            (401 | 403 | 404, _) => (
                format!("there is no {name}, or it is private (status {status})"),
                "see that the name is right; for a private model put a token into HF_TOKEN, which is sent over https only"
                    .to_owned(),
            ),
            _ => (
                format!("the server answers with status {status}"),
                "see HF_ENDPOINT where you have set it, and whether something on the way answers instead of the hub".to_owned(),
            ),
        };
        Trouble::Lasting(LocalError::Download { address: self.address.to_owned(), problem, hint })
    }

    fn wait(&self) -> Option<Duration> {
        let seconds = self.headers.get("retry-after")?.to_str().ok()?.trim().parse().ok()?;
        Some(Duration::from_secs(seconds))
    }
}

//! Failed requests: the reason, whether another attempt may succeed, and when to give up.

use super::name::HubModelName;
use crate::LocalError;
use std::{io::ErrorKind, thread, time::Duration};
use ureq::http::HeaderMap;

/// The number of failures in a row after which the program gives up on a file.
const MAX_FAILURES_IN_A_ROW: u32 = 5;

/// Longest wait between two requests, also where the server asks for more.
const MAX_RETRY_WAIT: Duration = Duration::from_secs(30);

/// The hint for an answer of the hub that is wrong.
pub(super) const TRY_LATER: &str = "try again later; if you have set HF_ENDPOINT, check it";

/// The hint for an answer that is not that of a hub.
pub(super) const CHECK_WHO_ANSWERS_HINT: &str =
    "if you have set HF_ENDPOINT, check it; check also whether something on the network answers instead of the hub";

/// Why a request failed.
#[derive(Debug)]
pub(super) enum RequestFailure {
    /// Another attempt may succeed in a moment, or after the wait that the server asks for.
    Passing { problem: String, wait: Option<Duration> },
    /// No other attempt will succeed.
    Lasting(LocalError),
}

impl RequestFailure {
    pub(super) fn from_problem(problem: String) -> Self {
        Self::Passing { problem, wait: None }
    }

    /// The failure of a request that got no answer with a status. The message names `host` instead of the address,
    /// which may contain a signature.
    pub(super) fn from_transport_error(error: &ureq::Error, address: &str, host: &str) -> Self {
        let problem = format!("{host}: {error}");
        let passes = match error {
            ureq::Error::Timeout(_) | ureq::Error::Protocol(_) => true,
            ureq::Error::Io(error) => matches!(
                error.kind(),
                ErrorKind::ConnectionReset
                    | ErrorKind::ConnectionAborted
                    | ErrorKind::BrokenPipe
                    | ErrorKind::UnexpectedEof
                    | ErrorKind::TimedOut
            ),
            _ => false,
        };
        if passes {
            return Self::from_problem(problem);
        }
        let hint = "check that this machine is online (HTTPS_PROXY, HF_ENDPOINT); with WAYWORD_OFFLINE=1 the program downloads nothing and says where to put the file";
        Self::Lasting(LocalError::download_failed(address, problem, hint))
    }

    /// The failure for a status that is no success, with a hint.
    pub(super) fn from_status(
        status: u16,
        headers: &HeaderMap,
        address: &str,
        model: &HubModelName,
        had_token: bool,
    ) -> Self {
        let unexpected = format!("the server answers with status {status}");
        if matches!(status, 408 | 429 | 500..=599) {
            let wait =
                header_text(headers, "retry-after").and_then(|wait| wait.trim().parse().ok()).map(Duration::from_secs);
            return Self::Passing { problem: unexpected, wait };
        }
        let name = format!("{}/{}", model.org, model.name);
        let (problem, hint) = match (status, error_code(headers)) {
            (401 | 403, "GatedRepo") => (
                format!("{name} is gated: its authors decide who may download it"),
                format!("accept its terms on the page of {name}, and put a token that may read it into HF_TOKEN"),
            ),
            (404, "RevisionNotFound") => (
                format!("{name} has no revision {}", model.revision),
                "check the branches, tags and commits on the model's page of the hub".to_owned(),
            ),
            (401 | 403, _) if had_token => (
                format!("the token in HF_TOKEN gives no access to {name} (status {status})"),
                "check that the name is right, and that the token is valid and may read the model".to_owned(),
            ),
            (401 | 403 | 404, _) => (
                format!("there is no {name}, or it is private (status {status})"),
                "check the name; for a private model, put a token into HF_TOKEN, which is sent over https only"
                    .to_owned(),
            ),
            _ => (unexpected, CHECK_WHO_ANSWERS_HINT.to_owned()),
        };
        Self::Lasting(LocalError::download_failed(address, problem, hint))
    }
}

/// Whether the answer means that the model exists but lacks the file. This is no error for an optional file.
pub(super) fn is_absence(status: u16, headers: &HeaderMap) -> bool {
    status == 404 && !["RepoNotFound", "RevisionNotFound"].contains(&error_code(headers))
}

/// The hub's own error code.
fn error_code(headers: &HeaderMap) -> &str {
    header_text(headers, "x-error-code").unwrap_or_default()
}

/// The text of a header.
pub(super) fn header_text<'a>(headers: &'a HeaderMap, name: &str) -> Option<&'a str> {
    headers.get(name)?.to_str().ok()
}

/// Counts failures, and decides whether another attempt is made and how long to wait before it.
#[derive(Debug)]
pub(super) struct RetryPatience {
    failures: u32,
    first_wait: Duration,
}

impl RetryPatience {
    /// Begins with this wait. Each later wait is twice as long as the one before.
    pub(super) fn new(first_wait: Duration) -> Self {
        Self { failures: 0, first_wait }
    }

    /// Forgets earlier failures, because there was progress.
    pub(super) fn forget_failures(&mut self) {
        self.failures = 0;
    }

    /// Waits before another attempt, or returns the error that ends the attempts.
    ///
    /// # Errors
    /// When no other attempt will succeed, or there were too many failures.
    pub(super) fn wait_or_give_up(&mut self, trouble: RequestFailure, address: &str) -> Result<(), LocalError> {
        let (problem, wait) = match trouble {
            RequestFailure::Passing { problem, wait } => (problem, wait),
            RequestFailure::Lasting(error) => return Err(error),
        };
        self.failures += 1;
        if self.failures >= MAX_FAILURES_IN_A_ROW {
            let problem = format!("{problem} ({MAX_FAILURES_IN_A_ROW} times in a row)");
            let hint = "try again later; the received part is kept, and the next try continues from there";
            return Err(LocalError::download_failed(address, problem, hint));
        }
        let own_wait = self.first_wait.saturating_mul(1 << (self.failures - 1));
        thread::sleep(wait.unwrap_or(own_wait).min(MAX_RETRY_WAIT));
        Ok(())
    }
}

//! What went wrong with a request, whether another one may do better, and how long that is tried.

use super::name::OnHub;
use crate::LocalError;
use std::{io::ErrorKind, thread, time::Duration};
use ureq::http::HeaderMap;

/// Failures in a row before a file is given up.
const MOST_FAILURES: u32 = 5;

/// Longest wait between two requests.
const LONGEST_WAIT: Duration = Duration::from_secs(30);

/// What to do where the hub does what it should not.
pub(super) const TRY_LATER: &str = "try again later; see HF_ENDPOINT where you have set it";

/// What to do where no hub answers.
pub(super) const SEE_WHO_ANSWERS: &str =
    "see HF_ENDPOINT where you have set it, and whether something on the way answers instead of the hub";

/// Why a request gave nothing.
#[derive(Debug)]
pub(super) enum Trouble {
    /// It may work in a moment, or after what the server asks for.
    Passing { problem: String, wait: Option<Duration> },
    /// It will not.
    Lasting(LocalError),
}

impl Trouble {
    pub(super) fn passing(problem: String) -> Self {
        Self::Passing { problem, wait: None }
    }

    /// What the client says of a request that no status came back for. `host` is named instead of the address, which may be
    /// signed.
    pub(super) fn unanswered(error: &ureq::Error, address: &str, host: &str) -> Self {
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
            return Self::passing(problem);
        }
        let hint = "see whether this machine is online (HTTPS_PROXY, HF_ENDPOINT); with WAYWORD_OFFLINE=1 nothing is asked for and the message says where to put the file";
        Self::Lasting(LocalError::download(address, problem, hint))
    }

    /// What a status means, and what to do about it.
    pub(super) fn refused(status: u16, headers: &HeaderMap, address: &str, model: &OnHub, had_token: bool) -> Self {
        let unexpected = format!("the server answers with status {status}");
        if matches!(status, 408 | 429 | 500..=599) {
            let wait = text(headers, "retry-after").and_then(|wait| wait.trim().parse().ok()).map(Duration::from_secs);
            return Self::Passing { problem: unexpected, wait };
        }
        let name = format!("{}/{}", model.org, model.name);
        let (problem, hint) = match (status, code(headers)) {
            (401 | 403, "GatedRepo") => (
                format!("{name} is gated: its authors give it to whom they have let in"),
                format!("accept its terms on the page of {name}, and put a token that may read it into HF_TOKEN"),
            ),
            (404, "RevisionNotFound") => (
                format!("{name} has no revision {}", model.revision),
                "see the branches, tags and commits on the hub's page of the model".to_owned(),
            ),
            (401 | 403, _) if had_token => (
                format!("the token in HF_TOKEN does not open {name} (status {status})"),
                "see that the name is right, and that the token is valid and may read it".to_owned(),
            ),
            (401 | 403 | 404, _) => (
                format!("there is no {name}, or it is private (status {status})"),
                "see that the name is right; for a private model put a token into HF_TOKEN, which is sent over https only"
                    .to_owned(),
            ),
            _ => (unexpected, SEE_WHO_ANSWERS.to_owned()),
        };
        Self::Lasting(LocalError::download(address, problem, hint))
    }
}

/// Whether the model is there and lacks the file, which may be no error.
pub(super) fn is_absence(status: u16, headers: &HeaderMap) -> bool {
    status == 404 && !["RepoNotFound", "RevisionNotFound"].contains(&code(headers))
}

/// The hub's own word for what is wrong.
fn code(headers: &HeaderMap) -> &str {
    text(headers, "x-error-code").unwrap_or_default()
}

/// What a header says.
pub(super) fn text<'a>(headers: &'a HeaderMap, name: &str) -> Option<&'a str> {
    headers.get(name)?.to_str().ok()
}

/// How long failures are borne.
#[derive(Debug)]
pub(super) struct Patience {
    failures: u32,
    first_wait: Duration,
}

impl Patience {
    /// The wait doubles from the first one.
    pub(super) fn new(first_wait: Duration) -> Self {
        Self { failures: 0, first_wait }
    }

    /// There was progress.
    pub(super) fn restored(&mut self) {
        self.failures = 0;
    }

    /// Waits before another try.
    ///
    /// # Errors
    /// When no other try will do better, or there were enough.
    pub(super) fn again(&mut self, trouble: Trouble, address: &str) -> Result<(), LocalError> {
        let (problem, wait) = match trouble {
            Trouble::Passing { problem, wait } => (problem, wait),
            Trouble::Lasting(error) => return Err(error),
        };
        self.failures += 1;
        if self.failures >= MOST_FAILURES {
            let problem = format!("{problem} ({MOST_FAILURES} times in a row)");
            let hint = "try again later; what has arrived is kept, and the next try goes on from there";
            return Err(LocalError::download(address, problem, hint));
        }
        let own = self.first_wait.saturating_mul(1 << (self.failures - 1));
        thread::sleep(wait.unwrap_or(own).min(LONGEST_WAIT));
        Ok(())
    }
}

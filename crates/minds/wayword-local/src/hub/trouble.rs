//! What went wrong with a request, and whether another one may do better.

use crate::LocalError;
use std::{io::ErrorKind, thread, time::Duration};

/// Failures in a row before a file is given up.
const MOST_FAILURES: u32 = 5;

/// Longest wait between two requests.
const LONGEST_WAIT: Duration = Duration::from_secs(30);

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
    pub(super) fn of(error: &ureq::Error, address: &str, host: &str) -> Self {
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
        Self::Lasting(LocalError::Download { address: address.to_owned(), problem, hint: hint.to_owned() })
    }
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
            return Err(LocalError::Download {
                address: address.to_owned(),
                problem: format!("{problem} ({MOST_FAILURES} times in a row)"),
                hint: "try again later; what has arrived is kept, and the next try goes on from there".to_owned(),
            });
        }
        let own = self.first_wait.saturating_mul(1 << (self.failures - 1));
        thread::sleep(wait.unwrap_or(own).min(LONGEST_WAIT));
        Ok(())
    }
}

//! Everything that can go wrong with a child, with the message and the advice for each. A message continues "the world
//! program ...".

use super::protocol::{PROTOCOL_VERSION, WORLD_FRAME};
use std::io;

/// Why a request was not answered.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ChildFault {
    #[error("cannot be started: {0}")]
    NotStarted(#[source] io::Error),
    #[error("died ({0})")]
    Died(String),
    #[error("closed its standard output, but is still running")]
    Closed,
    #[error("did not answer within {0} s")]
    Hung(f64),
    #[error("wrote a line of more than {0} bytes")]
    LongLine(usize),
    #[error("wrote a line that is not an answer ({reason}): {start:?}")]
    Nonsense { reason: String, start: String },
    #[error("answered request {found} when it was asked request {asked}")]
    WrongId { asked: u64, found: u64 },
    #[error("speaks version {0} of the protocol; Wayword speaks version {PROTOCOL_VERSION}")]
    Version(u64),
    #[error("uses the world frame {0:?}; it must be {WORLD_FRAME:?}")]
    Frame(String),
    #[error("sent a greeting that cannot be used: {0}")]
    Greeting(String),
    #[error("has another `name` or other `offers` in its greeting than before the restart")]
    Changed,
    #[error("was restarted as often as `restarts` allows, and is not started again; the last time it {0}")]
    GaveUp(String),
    #[error("refused the request: {message}")]
    Refused { code: Option<String>, message: String },
    #[error("sent an answer that cannot be used: {0}")]
    Misfit(String),
}

impl ChildFault {
    /// Whether the child can still be used: it understood the request, and answered this request and no other.
    pub(crate) fn leaves_child_usable(&self) -> bool {
        matches!(self, Self::Refused { .. } | Self::Misfit(_))
    }

    /// What to do about it.
    pub(crate) fn hint(&self) -> &'static str {
        match self {
            Self::NotStarted(_) => "check its path, that it is executable, and its arguments",
            Self::Died(_) | Self::Closed | Self::GaveUp(_) => {
                "correct the error above, or run the program yourself to see all of its output"
            }
            Self::Hung(_) => {
                "give it more time in the world file (answer_within_s, start_within_s), or find out why it is slow"
            }
            Self::LongLine(_) | Self::Nonsense { .. } | Self::WrongId { .. } => {
                "only answers may go to standard output, one JSON object per line; print all else to standard error"
            }
            Self::Version(_) => "use the platform.py that comes with this version of Wayword",
            Self::Frame(_) => {
                "convert to this frame in the world program, and name it in the greeting: see docs/PROCESS.md"
            }
            Self::Changed => "send the same greeting each time (docs/PROCESS.md)",
            Self::Greeting(_) | Self::Misfit(_) => "see docs/PROCESS.md for what an answer must contain",
            Self::Refused { .. } => "this message is the world program's own: look for its cause there",
        }
    }
}

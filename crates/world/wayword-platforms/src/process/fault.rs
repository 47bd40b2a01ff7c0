//! What can be wrong with a child, and the words for it.

use super::protocol::{FRAME, PROTOCOL};
use std::io;

/// Why a request was not answered.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Fault {
    #[error("cannot be started: {0}")]
    NotStarted(#[source] io::Error),
    #[error("died ({0})")]
    Died(String),
    #[error("closed its standard output, but lives on")]
    Closed,
    #[error("did not answer within {0} s")]
    Hung(f64),
    #[error("wrote a line of more than {0} bytes")]
    LongLine(usize),
    #[error("wrote what is no answer ({reason}): {start:?}")]
    Nonsense { reason: String, start: String },
    #[error("answered request {found} when it was asked request {asked}")]
    WrongId { asked: u64, found: u64 },
    #[error("speaks version {0} of the protocol; this is version {PROTOCOL}")]
    Version(u64),
    #[error("measures in {0:?}, which is not {FRAME:?}")]
    Frame(String),
    #[error("sent a greeting that cannot be used: {0}")]
    Greeting(String),
    #[error("offers other things than before it was restarted")]
    Changed,
    #[error("was restarted as often as is allowed, and is not started again; at last it {0}")]
    GaveUp(String),
    #[error("refuses: {message}")]
    Refused { code: Option<String>, message: String },
    #[error("sent an answer that cannot be used: {0}")]
    Misfit(String),
}

impl Fault {
    /// Whether the child can still be asked: it understood, and answered this request and no other.
    pub(crate) fn leaves_it_usable(&self) -> bool {
        matches!(self, Self::Refused { .. } | Self::Misfit(_))
    }

    /// What to do about it.
    pub(crate) fn hint(&self) -> &'static str {
        match self {
            Self::NotStarted(_) => "check that the program is there and may be run, and its arguments",
            Self::Died(_) | Self::Closed | Self::GaveUp(_) => "run it by hand: its own error output says more",
            Self::Hung(_) => {
                "give it more time in the world file (answer_within_s, start_within_s), or see why it is slow"
            }
            Self::LongLine(_) | Self::Nonsense { .. } | Self::WrongId { .. } => {
                "only answers may go to standard output, one JSON object a line; print everything else to standard error"
            }
            Self::Version(_) => "take the wayword_platform.py that came with this version",
            Self::Frame(_) => "convert in the child, and say so: see docs/PROCESS.md",
            Self::Greeting(_) | Self::Changed | Self::Misfit(_) => "docs/PROCESS.md says what an answer holds",
            Self::Refused { .. } => "this is the world's own answer",
        }
    }
}

//! What can go wrong with a build.

use super::{output::OutputError, zmtp::WireError};
use std::{io, net::SocketAddr};

/// Why a build does not give what it was asked for.
#[derive(Debug, thiserror::Error)]
pub enum TdwError {
    /// The port cannot be had.
    #[error("cannot listen on {address}: {source}; is another controller running there?")]
    Bind {
        /// Where.
        address: SocketAddr,
        /// What the system says.
        source: io::Error,
    },
    /// No build came.
    #[error("no build came to {address} within {seconds} s{}; start it as TDW.x86_64 -port {}", said(.last), address.port())]
    NoBuild {
        /// Where it was waited for.
        address: SocketAddr,
        /// How long.
        seconds: u64,
        /// What went wrong with the last one that tried.
        last: Option<WireError>,
    },
    /// The conversation with the build broke.
    #[error("the build at {address}: {source}")]
    Wire {
        /// Where it is.
        address: SocketAddr,
        /// What happened.
        source: WireError,
    },
    /// A frame that cannot be read.
    #[error("the build's {0}; is it of a version from 1.11 to 1.13?")]
    Output(#[from] OutputError),
    /// An answer without its last frame, the frame's number.
    #[error("the build's answer ends in a frame of {length} bytes: expected the frame's number, 4 bytes big-endian")]
    NoFrameNumber {
        /// How long that frame is.
        length: usize,
    },
    /// An answer that lacks what was asked for.
    #[error("the build sent no `{id}` though it was asked to {asked}; does this scene have it?")]
    Missing {
        /// The id of the missing frame.
        id: &'static str,
        /// What was asked.
        asked: &'static str,
    },
    /// The build never heard the commands.
    #[error("the build asked {times} times to be told again (`ftre`), and then was given up; see its log")]
    NeverHeard {
        /// How often.
        times: u32,
    },
    /// The build ended by itself.
    #[error("the build quit because of an error; its Player.log says which")]
    Quit,
    /// A picture that cannot be used.
    #[error("the picture of pass {pass}: {reason}")]
    Picture {
        /// The pass.
        pass: &'static str,
        /// What is wrong.
        reason: String,
    },
    /// What the user named cannot be used.
    #[error("{0}")]
    Scene(String),
}

fn said(last: &Option<WireError>) -> String {
    last.as_ref().map_or_else(String::new, |error| format!(" (one tried: {error})"))
}

impl TdwError {
    /// Whether a new build could do better: this one is gone, or talks nonsense.
    pub(super) fn is_loss(&self) -> bool {
        matches!(self, Self::Wire { .. } | Self::NeverHeard { .. } | Self::Quit | Self::NoFrameNumber { .. })
    }
}

//! Errors of a ThreeDWorld build.

use super::{output::OutputError, zmtp::WireError};
use std::{io, net::SocketAddr};

/// The reason why a request to a build failed.
#[derive(Debug, thiserror::Error)]
pub enum TdwError {
    /// The port cannot be opened.
    #[error("cannot listen on {address}: {source}; another controller may be running there")]
    Bind {
        /// The address of the port.
        address: SocketAddr,
        /// The error of the system.
        source: io::Error,
    },
    /// No build connected.
    #[error(
        "no ThreeDWorld build connected to {address} within {seconds} s{}; start it with TDW.x86_64 -port {}",
        describe_last_error(.last),
        address.port()
    )]
    NoBuild {
        /// Where the controller waited.
        address: SocketAddr,
        /// How long it waited.
        seconds: u64,
        /// What went wrong with the last connection that was tried.
        last: Option<WireError>,
    },
    /// The connection with the build broke.
    #[error("the build at {address}: {source}")]
    Wire {
        /// Where it is.
        address: SocketAddr,
        /// The error of the connection.
        source: WireError,
    },
    /// A frame that cannot be read.
    #[error("cannot read the build's {0}")]
    Output(#[from] OutputError),
    /// An answer without its last frame, the frame's number.
    #[error(
        "the last part of the build's answer has {length} bytes: expected the number of its rendered frame, 4 bytes big-endian"
    )]
    NoFrameNumber {
        /// How long that frame is.
        length: usize,
    },
    /// An answer that lacks a requested frame.
    #[error("the build sent no `{id}`, although the command {asked} asks for it")]
    Missing {
        /// The id of the missing frame.
        id: &'static str,
        /// The command that asked for it.
        asked: &'static str,
    },
    /// The build never received the commands.
    #[error("the build asked {times} times for the same commands (`ftre`), so Wayword gave up")]
    NeverHeard {
        /// How often the build asked.
        times: u32,
    },
    /// The build ended by itself.
    #[error("the build quit because of an error")]
    Quit,
    /// A picture that cannot be used.
    #[error("the picture of pass {pass}: {reason}")]
    Picture {
        /// The pass.
        pass: &'static str,
        /// The reason.
        reason: String,
    },
    /// A scene that the user named cannot be used.
    #[error("{0}")]
    Scene(String),
    /// The Python package `tdw` is needed and was not given, or cannot be used.
    #[error("{0}")]
    Package(String),
}

fn describe_last_error(last: &Option<WireError>) -> String {
    last.as_ref().map_or_else(String::new, |error| format!(" (the last connection failed: {error})"))
}

impl TdwError {
    /// Whether a new build may help, because this one is gone or sends wrong bytes.
    pub(super) fn is_loss(&self) -> bool {
        matches!(self, Self::Wire { .. } | Self::NeverHeard { .. } | Self::Quit | Self::NoFrameNumber { .. })
    }
}

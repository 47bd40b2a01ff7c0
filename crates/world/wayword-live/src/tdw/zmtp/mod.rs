//! ZeroMQ's wire protocol, as far as a REP and a REQ socket over TCP need it: ZMTP 3.0 with the NULL mechanism (RFC 23),
//! and ZMTP 2.0 (RFC 15) for builds with an older NetMQ.
//!
//! The crate `zeromq` 0.7 is not used, for three reasons. It allocates whatever length a frame announces before a byte
//! of the frame has come, so nine bytes from an unknown peer can exhaust the memory. It refuses peers older than 3.0. It needs
//! an async runtime. Tests check this module against it and against libzmq.

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

mod frames;
mod greeting;

use std::{
    io::{self, BufReader, Read},
    net::TcpStream,
    time::{Duration, Instant},
};

/// Which end of the connection a socket is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SocketRole {
    /// Answers: the controller.
    Rep,
    /// Asks: the build.
    #[cfg(feature = "stand-in")]
    Req,
}

/// Why a connection cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum WireError {
    /// The other side closed the connection.
    #[error("the other side closed the connection while {doing}")]
    Gone {
        /// The step that was under way.
        doing: &'static str,
    },
    /// No byte came, or could be sent, in time.
    #[error("timed out while {doing}")]
    Late {
        /// The step that was under way.
        doing: &'static str,
    },
    /// The system failed.
    #[error("{source} while {doing}")]
    Io {
        /// The step that was under way.
        doing: &'static str,
        /// The error of the system.
        source: io::Error,
    },
    /// Bytes that are not ZeroMQ, or more of them than are accepted.
    #[error("byte {at} of the connection: expected {expected}, found {found}")]
    Malformed {
        /// Position, counted from the first received byte.
        at: u64,
        /// The expected content.
        expected: &'static str,
        /// The actual content.
        found: String,
    },
}

impl WireError {
    fn from_io(source: io::Error, doing: &'static str) -> Self {
        match source.kind() {
            io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => Self::Late { doing },
            io::ErrorKind::UnexpectedEof
            | io::ErrorKind::ConnectionReset
            | io::ErrorKind::ConnectionAborted
            | io::ErrorKind::BrokenPipe => Self::Gone { doing },
            _ => Self::Io { doing, source },
        }
    }
}

/// A peer that has been greeted.
#[derive(Debug)]
pub(crate) struct ZmtpPeer {
    reader: BufReader<DeadlineStream>,
    /// Bytes taken so far, for messages about them.
    taken: u64,
}

/// A stream that reads until a deadline, however slowly the bytes come. A plain read timeout starts anew with each byte.
#[derive(Debug)]
struct DeadlineStream {
    stream: TcpStream,
    deadline: Instant,
}

impl DeadlineStream {
    /// The time until the deadline; an error if it has passed.
    fn time_left(&self) -> io::Result<Duration> {
        let left = self.deadline.saturating_duration_since(Instant::now());
        // For the system, a timeout of zero means "for ever".
        if left.is_zero() { Err(io::ErrorKind::TimedOut.into()) } else { Ok(left) }
    }
}

impl Read for DeadlineStream {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let left = self.time_left()?;
        self.stream.set_read_timeout(Some(left))?;
        self.stream.read(into)
    }
}

impl ZmtpPeer {
    /// Exchanges greetings with the other end of a connection.
    ///
    /// # Errors
    /// When the other end is not a ZeroMQ socket of the fitting kind, or does not answer by the deadline.
    pub(crate) fn greet(stream: TcpStream, role: SocketRole, deadline: Instant) -> Result<Self, WireError> {
        let set_up = |stream: &TcpStream| {
            stream.set_nonblocking(false)?;
            stream.set_nodelay(true)
        };
        set_up(&stream).map_err(|source| WireError::from_io(source, "setting up the connection"))?;
        let reader = BufReader::with_capacity(64 << 10, DeadlineStream { stream, deadline });
        let mut peer = Self { reader, taken: 0 };
        greeting::exchange_greetings(&mut peer, role)?;
        Ok(peer)
    }

    /// Every read and write from now on ends at `deadline`.
    pub(crate) fn set_deadline(&mut self, deadline: Instant) {
        self.reader.get_mut().deadline = deadline;
    }

    /// Whether bytes arrive, or the connection ends, within this time.
    #[cfg(feature = "stand-in")]
    pub(crate) fn has_news(&self, within: Duration) -> bool {
        let stream = &self.reader.get_ref().stream;
        !self.reader.buffer().is_empty()
            || (stream.set_read_timeout(Some(within)).is_ok() && stream.peek(&mut [0]).is_ok())
    }

    /// Takes exactly `N` bytes.
    fn take_bytes<const N: usize>(&mut self, doing: &'static str) -> Result<[u8; N], WireError> {
        let mut bytes = [0; N];
        self.reader.read_exact(&mut bytes).map_err(|source| WireError::from_io(source, doing))?;
        self.taken += N as u64;
        Ok(bytes)
    }

    /// Takes as many bytes as were announced. Memory grows with the bytes that really come.
    fn take_long(&mut self, length: u64, doing: &'static str) -> Result<Vec<u8>, WireError> {
        let mut bytes = Vec::with_capacity(usize::try_from(length.min(1 << 20)).unwrap_or(0));
        let outcome = (&mut self.reader).take(length).read_to_end(&mut bytes);
        outcome.map_err(|source| WireError::from_io(source, doing))?;
        self.taken += bytes.len() as u64;
        if (bytes.len() as u64) < length {
            return Err(WireError::Gone { doing });
        }
        Ok(bytes)
    }

    fn write_bytes(&mut self, bytes: &[u8], doing: &'static str) -> Result<(), WireError> {
        let timed = self.reader.get_mut();
        let written = timed.time_left().and_then(|left| {
            timed.stream.set_write_timeout(Some(left))?;
            io::Write::write_all(&mut timed.stream, bytes)
        });
        written.map_err(|source| WireError::from_io(source, doing))
    }

    /// The error for bytes that begin `back` bytes before the end of those taken so far.
    fn malformed_error(&self, back: u64, expected: &'static str, found: impl Into<String>) -> WireError {
        WireError::Malformed { at: self.taken.saturating_sub(back), expected, found: found.into() }
    }
}

//! Sends and receives messages after the greeting.
//!
//! A message is a list of frames. A frame has one byte of flags (1: more frames follow, 2: long length, 4: a command),
//! its length in 1 or 8 bytes, and its content.

use super::{WireError, ZmtpPeer};
use std::io::Write;

/// Longest message that is accepted: a few pictures of 8192 x 4096 raw pixels.
const MAX_MESSAGE_BYTES: u64 = 256 << 20;
/// Most frames that one message may have.
const MAX_FRAMES: usize = 4096;
/// Most commands (for example heartbeats) that are skipped between two messages.
const MAX_COMMANDS: usize = 64;

/// The header of a frame.
pub(super) struct FrameHeader {
    pub(super) command: bool,
    /// Whether more frames of the message follow.
    more: bool,
    length: u64,
}

impl ZmtpPeer {
    /// The next message without its envelope: everything after the empty frame that a REQ or REP socket puts first.
    ///
    /// # Errors
    /// When the connection ends or is late, or its bytes do not follow the protocol of REQ and REP sockets.
    pub(crate) fn receive(&mut self) -> Result<Vec<Vec<u8>>, WireError> {
        let mut frames = Vec::new();
        let mut in_envelope = true;
        let (mut bytes_left, mut commands) = (MAX_MESSAGE_BYTES, 0);
        loop {
            let header = self.read_header()?;
            let body = self.read_body(&header, bytes_left)?;
            if header.command {
                commands += 1;
                if commands > MAX_COMMANDS {
                    return Err(self.malformed_error(0, "a message", "more than 64 commands"));
                }
                continue;
            }
            bytes_left -= body.len() as u64;
            match in_envelope {
                true => in_envelope = !body.is_empty(),
                false => frames.push(body),
            }
            if frames.len() > MAX_FRAMES {
                return Err(self.malformed_error(0, "at most 4096 frames in a message", "more"));
            }
            if !header.more {
                let whole = !in_envelope && !frames.is_empty();
                return if whole {
                    Ok(frames)
                } else {
                    Err(self.malformed_error(0, "an empty frame and content", "not both"))
                };
            }
        }
    }

    /// Sends a message in its envelope.
    ///
    /// # Errors
    /// When the connection ends or is late.
    pub(crate) fn send(&mut self, frames: &[impl AsRef<[u8]>]) -> Result<(), WireError> {
        // Small frames are sent in one write; a large frame is not copied.
        let mut packet = vec![u8::from(!frames.is_empty()), 0];
        for (index, frame) in frames.iter().enumerate() {
            let (frame, more) = (frame.as_ref(), u8::from(index + 1 < frames.len()));
            match u8::try_from(frame.len()) {
                Ok(length) => packet.extend([more, length]),
                Err(_) => {
                    packet.push(more | 2);
                    packet.extend((frame.len() as u64).to_be_bytes());
                }
            }
            if frame.len() < 64 << 10 {
                packet.extend_from_slice(frame);
                continue;
            }
            self.write_bytes(&packet, "sending")?;
            packet.clear();
            self.write_bytes(frame, "sending")?;
        }
        self.write_bytes(&packet, "sending")?;
        self.reader.get_mut().stream.flush().map_err(|source| WireError::from_io(source, "sending"))
    }

    /// Reads the header of the next frame.
    pub(super) fn read_header(&mut self) -> Result<FrameHeader, WireError> {
        let doing = "waiting for a message";
        let [flags] = self.take_bytes(doing)?;
        if flags & !7 != 0 {
            return Err(self.malformed_error(1, "the flags of a frame (0 to 7)", flags.to_string()));
        }
        let length = if flags & 2 != 0 {
            u64::from_be_bytes(self.take_bytes(doing)?)
        } else {
            let [length] = self.take_bytes(doing)?;
            u64::from(length)
        };
        Ok(FrameHeader { command: flags & 4 != 0, more: flags & 1 != 0, length })
    }

    /// Reads the content of a frame; a frame of more than `max_bytes` is refused before it is read.
    pub(super) fn read_body(&mut self, header: &FrameHeader, max_bytes: u64) -> Result<Vec<u8>, WireError> {
        if header.length > max_bytes {
            let found = format!("one of {} bytes", header.length);
            return Err(self.malformed_error(
                8,
                "a frame that fits into the rest of 256 MiB (4 KiB for a command)",
                found,
            ));
        }
        self.take_long(header.length, "reading a message")
    }
}

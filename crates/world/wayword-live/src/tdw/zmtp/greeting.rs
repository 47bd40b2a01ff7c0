//! The greeting of two sockets: both send a signature and their revision of ZMTP, then continue in the older of the two
//! revisions.

use super::{SocketRole, WireError, ZmtpPeer};

/// The first bytes of a connection, as libzmq writes them: the oldest peers see a frame of length 1 in them.
const SIGNATURE: [u8; 10] = [0xff, 0, 0, 0, 0, 0, 0, 0, 1, 0x7f];
/// The step that errors name.
const GREETING_ACTION: &str = "greeting";
/// Longest command that is read, bytes.
const MAX_COMMAND_BYTES: u64 = 4096;

impl SocketRole {
    fn name(self) -> &'static str {
        match self {
            Self::Rep => "REP",
            #[cfg(feature = "stand-in")]
            Self::Req => "REQ",
        }
    }

    /// Its number in ZMTP 2.0.
    fn zmtp2_number(self) -> u8 {
        match self {
            Self::Rep => 4,
            #[cfg(feature = "stand-in")]
            Self::Req => 3,
        }
    }

    /// The kinds of socket that it talks to, by name and number.
    fn talks_to(self) -> [(&'static str, u8); 2] {
        match self {
            Self::Rep => [("REQ", 3), ("DEALER", 5)],
            #[cfg(feature = "stand-in")]
            Self::Req => [("REP", 4), ("ROUTER", 6)],
        }
    }
}

/// Sends our greeting, checks that of the peer, and finishes in the revision of ZMTP that both know.
pub(super) fn exchange_greetings(peer: &mut ZmtpPeer, role: SocketRole) -> Result<(), WireError> {
    peer.write_bytes(&[SIGNATURE.as_slice(), &[3]].concat(), GREETING_ACTION)?;
    let theirs: [u8; 10] = peer.take_bytes(GREETING_ACTION)?;
    let [first, .., last] = theirs;
    if first != 0xff || last & 1 == 0 {
        return Err(peer.malformed_error(10, "the signature of a ZeroMQ socket (ff .. 7f)", hex_text(&theirs)));
    }
    match peer.take_bytes::<1>(GREETING_ACTION)? {
        [0] => Err(peer.malformed_error(1, "ZMTP 2.0 or newer", "revision 0")),
        [1 | 2] => finish_zmtp2(peer, role),
        _ => finish_zmtp3(peer, role),
    }
}

/// ZMTP 2.0: the kind of socket as a number, and an identity.
fn finish_zmtp2(peer: &mut ZmtpPeer, role: SocketRole) -> Result<(), WireError> {
    peer.write_bytes(&[role.zmtp2_number(), 0, 0], GREETING_ACTION)?;
    let [kind] = peer.take_bytes(GREETING_ACTION)?;
    if role.talks_to().iter().all(|(_, number)| *number != kind) {
        return Err(peer.malformed_error(1, "a socket that fits (REQ talks to REP)", format!("socket type {kind}")));
    }
    let header = peer.read_header()?;
    peer.read_body(&header, MAX_COMMAND_BYTES).map(drop)
}

/// ZMTP 3.0: the rest of the greeting, then READY from both.
fn finish_zmtp3(peer: &mut ZmtpPeer, role: SocketRole) -> Result<(), WireError> {
    let mut rest = [0; 53];
    for (place, letter) in rest.iter_mut().skip(1).zip(b"NULL") {
        *place = *letter;
    }
    peer.write_bytes(&rest, GREETING_ACTION)?;
    let theirs: [u8; 53] = peer.take_bytes(GREETING_ACTION)?;
    let mechanism = theirs.get(1..21).unwrap_or_default();
    if Some(mechanism) != rest.get(1..21) {
        return Err(peer.malformed_error(52, "the mechanism NULL", hex_text(mechanism)));
    }
    peer.write_bytes(&ready_command(role), GREETING_ACTION)?;
    let header = peer.read_header()?;
    if !header.command {
        return Err(peer.malformed_error(1, "the command READY", "a message"));
    }
    let body = peer.read_body(&header, MAX_COMMAND_BYTES)?;
    let kind = socket_type(&body).ok_or_else(|| {
        peer.malformed_error(
            body.len() as u64,
            "the command READY with a Socket-Type",
            hex_text(body.get(..24).unwrap_or(&body)),
        )
    })?;
    if role.talks_to().iter().all(|(name, _)| name.as_bytes() != kind) {
        let found = format!("a {} socket", String::from_utf8_lossy(kind.get(..16).unwrap_or(kind)));
        return Err(peer.malformed_error(body.len() as u64, "a socket that fits (REQ talks to REP)", found));
    }
    Ok(())
}

/// The frame with the command READY, which names the type of our socket.
fn ready_command(role: SocketRole) -> Vec<u8> {
    let mut body = b"\x05READY".to_vec();
    for (name, value) in [("Socket-Type", role.name()), ("Identity", "")] {
        body.push(u8::try_from(name.len()).unwrap_or(u8::MAX));
        body.extend_from_slice(name.as_bytes());
        body.extend_from_slice(&u32::try_from(value.len()).unwrap_or(u32::MAX).to_be_bytes());
        body.extend_from_slice(value.as_bytes());
    }
    [&[4, u8::try_from(body.len()).unwrap_or(u8::MAX)], body.as_slice()].concat()
}

/// The property Socket-Type of a READY command. Case does not matter in the names of properties (RFC 23).
fn socket_type(body: &[u8]) -> Option<&[u8]> {
    let mut rest = body.strip_prefix(b"\x05READY")?;
    while let Some((length, after)) = rest.split_first() {
        let (name, after) = after.split_at_checked(usize::from(*length))?;
        let (length, after) = after.split_first_chunk()?;
        let (value, after) = after.split_at_checked(u32::from_be_bytes(*length) as usize)?;
        if name.eq_ignore_ascii_case(b"Socket-Type") {
            return Some(value);
        }
        rest = after;
    }
    None
}

fn hex_text(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().join(" ")
}

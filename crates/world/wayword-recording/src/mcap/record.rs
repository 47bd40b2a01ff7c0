//! A record of an MCAP file, with its place and its bytes.

use mcap::records::{Record, op};
use std::fmt;
use wayword_core::contain_panics::run_decoder;

/// The place at which a record begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct RecordPlace {
    /// Offset in the file; for a record in a compressed chunk, the offset of that chunk.
    pub(crate) file_at: u64,
    /// Offset in that chunk once it is unpacked.
    pub(crate) within: Option<u64>,
}

impl fmt::Display for RecordPlace {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.within {
            Some(within) => write!(out, "byte {within} of the chunk at byte {}", self.file_at),
            None => write!(out, "byte {}", self.file_at),
        }
    }
}

/// A record as it was read, before it is parsed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct McapRecord<'a> {
    pub(crate) opcode: u8,
    pub(crate) place: RecordPlace,
    /// The bytes of its body; for a message perhaps only the first of them.
    pub(crate) bytes: &'a [u8],
}

impl<'a> McapRecord<'a> {
    /// Parses the bytes.
    ///
    /// # Errors
    /// When it is broken; the error includes its place.
    pub(crate) fn parse_record(&self) -> Result<Record<'a>, String> {
        let parsed = check_text_lengths(self.opcode, self.bytes)
            .ok_or_else(|| "a length in the record is larger than the record".to_owned());
        let parse = || mcap::parse_record(self.opcode, self.bytes).map_err(|error| error.to_string());
        parsed.and_then(|()| run_decoder(parse)).map_err(|why| format!("{}: {why}", self.place))
    }
}

/// `None` if a text of a record is longer than the record. This is checked first because `mcap` reserves the memory that
/// a text's length asks for before it checks whether the bytes are there.
fn check_text_lengths(opcode: u8, body: &[u8]) -> Option<()> {
    let mut rest = body;
    // The numbers are the bytes before each text, as in the specification of MCAP.
    match opcode {
        op::SCHEMA => drop((next_text(&mut rest, 2)?, next_text(&mut rest, 0)?)),
        op::CHUNK_INDEX => drop((next_text(&mut rest, 32)?, next_text(&mut rest, 8)?)),
        op::CHANNEL => {
            let (_topic, _encoding, mut metadata) =
                (next_text(&mut rest, 4)?, next_text(&mut rest, 0)?, next_text(&mut rest, 0)?);
            while !metadata.is_empty() {
                next_text(&mut metadata, 0)?;
            }
        }
        // These have no texts.
        op::MESSAGE | op::STATISTICS | op::FOOTER => {}
        _ => return None,
    }
    Some(())
}

/// Skips `before_bytes` bytes, and takes the text that follows: first its length, then the text itself.
fn next_text<'a>(rest: &mut &'a [u8], before_bytes: usize) -> Option<&'a [u8]> {
    let (count, behind) = rest.get(before_bytes..)?.split_first_chunk()?;
    let (text, behind) = behind.split_at_checked(usize::try_from(u32::from_le_bytes(*count)).ok()?)?;
    *rest = behind;
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(text: &str) -> Vec<u8> {
        [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat()
    }

    #[test]
    fn check_text_lengths_refuses_lengths_beyond_the_record() {
        let pairs = [text("key"), text("value")].concat();
        let counted_pairs = [(pairs.len() as u32).to_le_bytes().to_vec(), pairs].concat();
        let channel = [vec![1, 0, 2, 0], text("/camera"), text("cdr"), counted_pairs].concat();
        assert!(check_text_lengths(op::CHANNEL, &channel).is_some());
        for length_at in [4, 4 + 4 + 7, 4 + 4 + 7 + 4 + 3, 4 + 4 + 7 + 4 + 3 + 4, 4 + 4 + 7 + 4 + 3 + 4 + 4 + 3] {
            let mut broken = channel.clone();
            broken[length_at + 3] = 0x65;
            assert!(check_text_lengths(op::CHANNEL, &broken).is_none(), "the length at byte {length_at} was believed");
        }
        assert!((0..channel.len()).all(|end| check_text_lengths(op::CHANNEL, &channel[..end]).is_none()));
    }
}

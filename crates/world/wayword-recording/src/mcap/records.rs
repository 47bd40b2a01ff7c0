//! The records of an MCAP file, one after the other, out of the file or out of a compressed chunk (mcap.dev/spec).
//!
//! Nothing is held but the record that is asked for: chunks are decompressed as they are read, and what is not asked for is passed
//! over, in the file without reading it.

use lz4_flex::frame::FrameDecoder;
use ruzstd::StreamingDecoder;
use std::{
    fs::File,
    io::{BufReader, Error, ErrorKind, Read, Seek, SeekFrom, Take, copy, sink},
};
use wayword_core::contained;

pub(crate) const SCHEMA: u8 = 3;
pub(crate) const CHANNEL: u8 = 4;
pub(crate) const MESSAGE: u8 = 5;
pub(crate) const CHUNK: u8 = 6;
pub(crate) const DATA_END: u8 = 15;

/// Bytes of a record before its body: what it is, and how long.
const HEAD_BYTES: u64 = 9;
/// What is read from the file at once: a picture's beginning is short, and the rest may be passed over.
const BUFFER_BYTES: usize = 16 << 10;
/// A chunk may become this large, and so many times larger than it is in the file.
const MAX_UNPACKED: (u64, u64) = (256 << 20, 1000);

/// Records in a row.
pub(crate) struct Records<'a> {
    from: From<'a>,
    /// Of the next byte, counted from the first record.
    at: u64,
    /// Of the byte behind the last record.
    end: u64,
    /// Of the byte behind the record that was found last.
    next: u64,
    /// Where in the file it begins, for errors.
    origin: Origin,
}

enum From<'a> {
    File(BufReader<&'a File>),
    Unpacked(Contained<Box<dyn Read + 'a>>),
}

#[derive(Clone, Copy)]
enum Origin {
    File(u64),
    Chunk(u64),
}

/// A record that was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Found {
    pub(crate) opcode: u8,
    /// Where it begins, counted from the first record.
    pub(crate) at: u64,
}

/// What stands before a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct MessageHead {
    pub(crate) channel: u16,
    pub(crate) logged_ns: i64,
}

impl<'a> Records<'a> {
    /// The records in a part of the file.
    pub(crate) fn in_file(mut file: &'a File, from: u64, to: u64) -> Result<Self, String> {
        file.seek(SeekFrom::Start(from)).map_err(|error| format!("byte {from}: {error}"))?;
        let reader = BufReader::with_capacity(BUFFER_BYTES, file);
        let end = to.saturating_sub(from);
        Ok(Self { from: From::File(reader), at: 0, end, next: 0, origin: Origin::File(from) })
    }

    /// The records in the chunk that begins at a byte of the file.
    pub(crate) fn in_chunk(file: &'a File, at: u64) -> Result<Self, String> {
        let mut records = Self::in_file(file, at, u64::MAX)?;
        let head = records.exactly::<{ HEAD_BYTES as usize }>()?;
        if head[0] != CHUNK {
            return Err(format!("byte {at}: a chunk was expected, not a record of type {:#04x}", head[0]));
        }
        let fixed = records.exactly::<32>()?;
        let (unpacked_bytes, name_bytes) =
            (u64_at(&fixed, 16), u32::from_le_bytes([fixed[28], fixed[29], fixed[30], fixed[31]]));
        let mut compression = Vec::new();
        records.read(u64::from(name_bytes.min(64)), &mut compression)?;
        let packed_bytes = u64::from_le_bytes(records.exactly()?);
        let From::File(reader) = records.from else { return Err(format!("byte {at}: is no chunk")) };
        match &*compression {
            b"" => {
                let origin = Origin::File(at + records.at);
                return Ok(Self { from: From::File(reader), at: 0, end: packed_bytes, next: 0, origin });
            }
            b"lz4" | b"zstd" => {}
            _ => {
                let name = String::from_utf8_lossy(&compression).into_owned();
                return Err(format!("byte {at}: a chunk is compressed as {name:?}; lz4 and zstd can be read"));
            }
        }
        let most = MAX_UNPACKED.0.saturating_add(packed_bytes.saturating_mul(MAX_UNPACKED.1));
        if unpacked_bytes > most {
            return Err(format!("byte {at}: a chunk of {packed_bytes} bytes says that it holds {unpacked_bytes}"));
        }
        let unpacking = unpacking(compression == b"zstd", reader.take(packed_bytes));
        let unpacking = unpacking.map_err(|error| format!("byte {at}: a chunk cannot be decompressed: {error}"))?;
        let from = From::Unpacked(Contained(unpacking));
        Ok(Self { from, at: 0, end: unpacked_bytes, next: 0, origin: Origin::Chunk(at) })
    }

    /// Goes to the next record; `None` behind the last.
    pub(crate) fn next(&mut self) -> Result<Option<Found>, String> {
        self.pass_to(self.next)?;
        let at = self.at;
        if at == self.end {
            return Ok(None);
        }
        let head = self.exactly::<{ HEAD_BYTES as usize }>()?;
        let (opcode, length) = (head[0], u64_at(&head, 1));
        let next = self.at.saturating_add(length);
        // Of a chunk that was cut off something can be read.
        if next > self.end && opcode != CHUNK {
            return Err(format!("{}: a record of {length} bytes is cut off", self.place(at)));
        }
        self.next = next.min(self.end);
        Ok(Some(Found { opcode, at }))
    }

    /// Goes to the record that begins at a byte, which lies ahead of all that was read.
    pub(crate) fn go(&mut self, at: u64) -> Result<Option<Found>, String> {
        self.next = at;
        self.next()
    }

    /// What stands before the message that was found.
    pub(crate) fn message(&mut self) -> Result<MessageHead, String> {
        let head = self.exactly::<22>()?;
        let logged_ns = i64::try_from(u64_at(&head, 6)).unwrap_or(i64::MAX);
        Ok(MessageHead { channel: u16::from_le_bytes([head[0], head[1]]), logged_ns })
    }

    /// What is left of the record that was found, or the first bytes of it.
    pub(crate) fn body(&mut self, most: u64, into: &mut Vec<u8>) -> Result<(), String> {
        self.read(self.next.saturating_sub(self.at).min(most), into)
    }

    /// How much is left of the record that was found.
    pub(crate) fn left(&self) -> u64 {
        self.next.saturating_sub(self.at)
    }

    /// Where the record that was found ends.
    pub(crate) fn behind(&self) -> u64 {
        self.next
    }

    /// Whether a byte lies ahead of all that was read.
    pub(crate) fn is_ahead(&self, at: u64) -> bool {
        at >= self.at
    }

    /// Where a byte is, for errors.
    pub(crate) fn place(&self, at: u64) -> String {
        match self.origin {
            Origin::File(from) => format!("byte {}", from.saturating_add(at)),
            Origin::Chunk(chunk) => format!("byte {at} of the chunk at byte {chunk}"),
        }
    }

    fn exactly<const BYTES: usize>(&mut self) -> Result<[u8; BYTES], String> {
        let mut bytes = [0; BYTES];
        let read = match &mut self.from {
            From::File(reader) => reader.read_exact(&mut bytes),
            From::Unpacked(reader) => reader.read_exact(&mut bytes),
        };
        read.map_err(|error| self.broken(&error))?;
        self.at += BYTES as u64;
        Ok(bytes)
    }

    fn read(&mut self, count: u64, into: &mut Vec<u8>) -> Result<(), String> {
        into.clear();
        // Grows with what is really there, whatever a length says.
        let read = match &mut self.from {
            From::File(reader) => reader.take(count).read_to_end(into),
            From::Unpacked(reader) => reader.take(count).read_to_end(into),
        };
        let read =
            read.and_then(|read| if read as u64 == count { Ok(()) } else { Err(ErrorKind::UnexpectedEof.into()) });
        read.map_err(|error| self.broken(&error))?;
        self.at += count;
        Ok(())
    }

    fn pass_to(&mut self, at: u64) -> Result<(), String> {
        let count = at.saturating_sub(self.at);
        let passed = match &mut self.from {
            From::File(reader) => {
                i64::try_from(count).map_err(Error::other).and_then(|count| reader.seek_relative(count))
            }
            From::Unpacked(reader) => copy(&mut reader.take(count), &mut sink()).map(drop),
        };
        passed.map_err(|error| self.broken(&error))?;
        self.at += count;
        Ok(())
    }

    fn broken(&self, error: &Error) -> String {
        match error.kind() {
            ErrorKind::UnexpectedEof => format!("{}: ends in the middle of a record", self.place(self.at)),
            _ => format!("{}: {error}", self.place(self.at)),
        }
    }
}

fn unpacking<'a>(zstd: bool, packed: Take<BufReader<&'a File>>) -> Result<Box<dyn Read + 'a>, String> {
    if !zstd {
        return Ok(Box::new(FrameDecoder::new(packed)));
    }
    let begun = contained(|| StreamingDecoder::new(packed).map_err(|error| error.to_string()));
    Ok(Box::new(begun.unwrap_or_else(|| Err("is broken".to_owned()))?))
}

/// Somebody else's decoder, whose panics on broken input become errors.
struct Contained<R>(R);

impl<R: Read> Read for Contained<R> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let read = contained(|| self.0.read(into));
        read.unwrap_or_else(|| Err(Error::other("cannot be decompressed")))
    }
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    let mut number = [0; 8];
    number.copy_from_slice(&bytes[at..at + 8]);
    u64::from_le_bytes(number)
}

//! Reads those records of an MCAP file that concern messages, one after another, also in chunks (mcap.dev/spec).
//!
//! The crate `mcap` unpacks compressed chunks, a record at a time. Everything else is read here, because the crate
//! reads every record whole, while only the first bytes of a picture are needed to find its time. It also reads chunks that are not
//! compressed and have a checksum, up to a size.

use super::record::{McapRecord, RecordPlace};
use mcap::{
    McapError,
    records::op,
    sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions},
};
use std::{
    fs::File,
    io::{BufReader, Error, ErrorKind, Read, Seek, SeekFrom},
    ops::ControlFlow,
};
use wayword_core::run_contained;

/// Bytes of a record before its body: its type and length.
const HEAD_BYTES: u64 = 9;
/// Bytes of a chunk's body before its records, where these are not compressed.
const CHUNK_HEAD_BYTES: u64 = 40;
/// Bytes of a message's body before its payload.
const MESSAGE_HEAD_BYTES: u64 = 22;
/// Longest schema, channel or index of a chunk's messages, bytes; of a longer record only this many are read.
const MAX_RECORD_BYTES: u64 = 64 << 20;
/// Bytes that are read from the file at once: a picture's head is short, and the rest may be skipped.
const BUFFER_BYTES: usize = 16 << 10;
/// Largest chunk that is not compressed and whose checksum is compared, bytes. A larger one is only read where a message is needed.
const MAX_CHECKED_BYTES: u64 = 16 << 20;
/// A chunk may unpack to the first number of bytes plus the second number times its size in the file.
const MAX_UNPACKED: (u64, u64) = (256 << 20, 1000);
/// The limit for a record is the size of its unpacked chunk, but within these bounds, bytes. The crate makes room for a
/// whole record before its bytes are there, so the upper bound is that of the largest picture.
const UNPACKED_RECORD: (u64, u64) = (64 << 10, 258 << 20);

/// Most bytes of a message that the caller needs, by channel.
pub(crate) type NeededBytes<'a> = dyn Fn(u16) -> u64 + 'a;

/// Receives records, and can stop the reading.
pub(crate) type HearRecord<'a> = dyn FnMut(McapRecord<'_>) -> Result<ControlFlow<()>, String> + 'a;

/// Records in a part of a file.
pub(crate) struct RecordReader<'a> {
    file: BufReader<&'a File>,
    /// Offset of the next record, or of the compressed chunk that is open.
    at: u64,
    /// No records begin from this offset on.
    end: u64,
    /// End of the chunk that was entered last, if it is not compressed.
    chunk_end: u64,
    /// The compressed chunk that is open.
    packed: Option<PackedChunk>,
    /// The bytes of the last record that were read.
    body: Vec<u8>,
}

impl<'a> RecordReader<'a> {
    pub(crate) fn new(file: &'a File, from: u64, end: u64) -> Result<Self, String> {
        let file = BufReader::with_capacity(BUFFER_BYTES, file);
        let mut records = Self { file, at: 0, end, chunk_end: 0, packed: None, body: Vec::new() };
        records.go_to(RecordPlace { file_at: from, within: None })?;
        Ok(records)
    }

    /// Goes to a record. For a record in a compressed chunk it goes to the start of that chunk, unless the chunk is
    /// open and the record is still ahead.
    pub(crate) fn go_to(&mut self, to: RecordPlace) -> Result<(), String> {
        let ahead =
            |packed: &PackedChunk| packed.from == to.file_at && to.within.is_some_and(|within| within >= packed.at);
        if !self.packed.as_ref().is_some_and(ahead) {
            (self.at, self.chunk_end, self.packed) = (to.file_at, 0, None);
            self.file.seek(SeekFrom::Start(to.file_at)).map_err(|error| self.broken_at(&error))?;
        }
        Ok(())
    }

    /// Enters the chunk that must be here.
    pub(crate) fn enter_chunk(&mut self) -> Result<(), String> {
        match self.read_head()? {
            (op::CHUNK, length) => self.open_chunk(length),
            (opcode, _) => Err(format!("byte {}: expected a chunk, found a record of type {opcode:#04x}", self.at)),
        }
    }

    /// Offset of the next record, or the end of the compressed chunk that is open.
    pub(crate) fn reached_offset(&self) -> u64 {
        self.packed.as_ref().map_or(self.at, |packed| packed.end)
    }

    /// Hands out records up to the end of the data, or until `hear` stops it. The caller can go on with
    /// [`RecordReader::go_to`].
    ///
    /// # Errors
    /// When the file is broken, or `hear` fails.
    pub(crate) fn each_record(
        &mut self,
        most: &NeededBytes<'_>,
        hear: &mut HearRecord<'_>,
    ) -> Result<ControlFlow<()>, String> {
        loop {
            if let Some(packed) = &mut self.packed {
                if packed.each_record(&mut self.file, most, hear)?.is_break() {
                    return Ok(ControlFlow::Break(()));
                }
                (self.at, self.packed) = (packed.end, None);
            }
            if self.at >= self.end {
                return Ok(ControlFlow::Continue(()));
            }
            match self.read_head()? {
                (op::DATA_END, _) => return Ok(ControlFlow::Continue(())),
                (op::CHUNK, length) => self.open_chunk(length)?,
                (opcode, length) => {
                    let is_wanted = self.read_body(opcode, length, most)?;
                    let place = RecordPlace { file_at: self.at, within: None };
                    if is_wanted && hear(McapRecord { opcode, place, bytes: &self.body })?.is_break() {
                        return Ok(ControlFlow::Break(()));
                    }
                    self.at += HEAD_BYTES + length;
                }
            }
        }
    }

    /// Type of the next record, and length of its body.
    fn read_head(&mut self) -> Result<(u8, u64), String> {
        let [opcode] = self.read_exactly::<1>()?;
        let length = u64::from_le_bytes(self.read_exactly()?);
        let end = if self.at < self.chunk_end { self.chunk_end } else { self.end };
        // A chunk that was cut off can still be read in part.
        if opcode != op::CHUNK && length > end.saturating_sub(self.at + HEAD_BYTES) {
            return Err(format!("byte {}: a record of {length} bytes is cut off", self.at));
        }
        Ok((opcode, length))
    }

    /// Enters the chunk after its head was read.
    fn open_chunk(&mut self, length: u64) -> Result<(), String> {
        let from = self.at;
        let end = from.saturating_add(HEAD_BYTES).saturating_add(length).min(self.end);
        // A chunk's head: two times, the unpacked length, a checksum, the length of the compression's name, the name (empty if
        // not compressed), and then the length of the records.
        self.read_exactly::<16>()?;
        let unpacked_bytes = u64::from_le_bytes(self.read_exactly()?);
        let has_checksum = self.read_exactly::<4>()? != [0; 4];
        let is_packed = self.read_exactly::<4>()? != [0; 4];
        let records_bytes = u64::from_le_bytes(self.read_exactly()?);
        let is_whole = from.saturating_add(HEAD_BYTES).saturating_add(length) <= self.end;
        let is_checked = has_checksum && is_whole && length <= MAX_CHECKED_BYTES;
        // The crate compares checksums, and handles all unusual chunks.
        if !is_packed && !is_checked && records_bytes.checked_add(CHUNK_HEAD_BYTES) == Some(length) {
            (self.at, self.chunk_end) = (from + HEAD_BYTES + CHUNK_HEAD_BYTES, end);
            return Ok(());
        }
        let packed_bytes = end - from;
        if is_packed && unpacked_bytes > MAX_UNPACKED.0.saturating_add(packed_bytes.saturating_mul(MAX_UNPACKED.1)) {
            return Err(format!(
                "byte {from}: a chunk of {packed_bytes} bytes claims to unpack to {unpacked_bytes} bytes"
            ));
        }
        let back = -(HEAD_BYTES + CHUNK_HEAD_BYTES).cast_signed();
        self.file.seek_relative(back).map_err(|error| self.broken_at(&error))?;
        let record_bytes = unpacked_bytes.clamp(UNPACKED_RECORD.0, UNPACKED_RECORD.1);
        let record_bytes = usize::try_from(record_bytes).unwrap_or(usize::MAX);
        let options = LinearReaderOptions::default().with_skip_start_magic(true).with_skip_end_magic(true);
        let options = options.with_validate_chunk_crcs(true);
        let reader = LinearReader::new_with_options(options.with_record_length_limit(record_bytes));
        self.packed = Some(PackedChunk { reader, from, end, left: packed_bytes, at: 0 });
        Ok(())
    }

    /// Reads the needed first bytes of a body and skips the rest. Returns whether the record concerns messages.
    fn read_body(&mut self, opcode: u8, length: u64, most: &NeededBytes<'_>) -> Result<bool, String> {
        self.body.clear();
        // The first two bytes of a message are its channel, which determines how many bytes are needed.
        let begun = length.min(2);
        self.append_bytes(begun)?;
        let wanted = wanted_bytes(opcode, &self.body, most);
        let read = wanted.unwrap_or(0).clamp(begun, length);
        self.append_bytes(read - begun)?;
        let passed = i64::try_from(length - read).map_err(Error::other);
        passed.and_then(|passed| self.file.seek_relative(passed)).map_err(|error| self.broken_at(&error))?;
        Ok(wanted.is_some())
    }

    /// Reads bytes of the file to the end of `body`.
    fn append_bytes(&mut self, count: u64) -> Result<(), String> {
        // Memory grows only with the bytes that the file really has.
        match self.file.by_ref().take(count).read_to_end(&mut self.body) {
            Ok(read) if read as u64 == count => Ok(()),
            Ok(_) => Err(self.broken_at(&ErrorKind::UnexpectedEof.into())),
            Err(error) => Err(self.broken_at(&error)),
        }
    }

    fn read_exactly<const BYTES: usize>(&mut self) -> Result<[u8; BYTES], String> {
        let mut bytes = [0; BYTES];
        self.file.read_exact(&mut bytes).map_err(|error| self.broken_at(&error))?;
        Ok(bytes)
    }

    fn broken_at(&self, error: &Error) -> String {
        match error.kind() {
            ErrorKind::UnexpectedEof => format!("byte {}: the file ends in the middle of a record", self.at),
            _ => format!("byte {}: {error}", self.at),
        }
    }
}

/// A chunk that is unpacked while its records are read.
struct PackedChunk {
    reader: LinearReader,
    /// Its beginning and end in the file.
    from: u64,
    end: u64,
    /// Bytes of it that have not been read yet.
    left: u64,
    /// Offset of the next record in the unpacked chunk.
    at: u64,
}

impl PackedChunk {
    fn each_record(
        &mut self,
        file: &mut BufReader<&File>,
        most: &NeededBytes<'_>,
        hear: &mut HearRecord<'_>,
    ) -> Result<ControlFlow<()>, String> {
        loop {
            let from = self.from;
            let place = RecordPlace { file_at: from, within: Some(self.at) };
            let event =
                run_contained(|| self.reader.next_event()).ok_or_else(|| format!("{place}: cannot be unpacked"))?;
            match event.transpose().map_err(|error| chunk_fault(&error, from, place))? {
                None => return Ok(ControlFlow::Continue(())),
                Some(LinearReadEvent::ReadRequest(count)) => {
                    // If the chunk ends too early this is less, or 0; the reader reports that.
                    let count = usize::try_from(self.left).map_or(count, |left| left.min(count));
                    file.read_exact(self.reader.insert(count)).map_err(|error| format!("{place}: {error}"))?;
                    self.reader.notify_read(count);
                    self.left -= count as u64;
                }
                Some(LinearReadEvent::Record { opcode, data }) => {
                    self.at += HEAD_BYTES + data.len() as u64;
                    let Some(most) = wanted_bytes(opcode, data, most) else { continue };
                    let bytes = usize::try_from(most).ok().and_then(|most| data.get(..most)).unwrap_or(data);
                    if hear(McapRecord { opcode, place, bytes })?.is_break() {
                        return Ok(ControlFlow::Break(()));
                    }
                }
            }
        }
    }
}

/// Why a chunk that begins at `from` cannot be read on.
fn chunk_fault(error: &McapError, from: u64, place: RecordPlace) -> String {
    match error {
        McapError::BadChunkCrc { .. } => {
            format!("the chunk at byte {from} is damaged: its checksum does not fit its contents")
        }
        error => format!("{place}: {error}"),
    }
}

/// Most bytes of a record that are needed; `None` if it does not concern messages.
fn wanted_bytes(opcode: u8, body: &[u8], most: &NeededBytes<'_>) -> Option<u64> {
    let id = body.first_chunk().copied().map_or(0, u16::from_le_bytes);
    match opcode {
        op::MESSAGE => Some(MESSAGE_HEAD_BYTES + most(id)),
        op::SCHEMA | op::CHANNEL | op::CHUNK_INDEX | op::STATISTICS | op::FOOTER => Some(MAX_RECORD_BYTES),
        _ => None,
    }
}

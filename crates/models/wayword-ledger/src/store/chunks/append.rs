//! Writes a chunk's file. A line counts as written once the disk has it.

use super::line::{CHUNK_LINE_FORMAT, ChunkEntry};
use crate::{
    LedgerError, LedgerLocation,
    recording::MAX_LINE_BYTES,
    store::commit_queue::{CommitQueue, GroupCommit},
};
use std::{
    fs::{File, OpenOptions},
    io::{self, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
};

/// Passes lines to the thread that writes them. When it is dropped, all pending lines are written first.
#[derive(Debug)]
pub(super) struct ChunkAppender {
    lines: CommitQueue<Vec<u8>, ()>,
    path: PathBuf,
}

impl ChunkAppender {
    /// Goes on with a file of which the first `sound` bytes are intact. The rest is cut off.
    pub(super) fn start(path: &Path, sound: u64) -> Result<Self, LedgerError> {
        let failed = LedgerError::io_error(path, "write the recording");
        let mut options = OpenOptions::new();
        options.create(true).truncate(false).write(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        let file = options.open(path).map_err(&failed)?;
        let mut tail = ChunkFileTail { file, place: LedgerLocation::from_path(path), sound, is_torn: true };
        if sound == 0 {
            let first =
                ChunkEntry::Ledger { format: CHUNK_LINE_FORMAT }.to_line().map_err(|error| failed(error.into()))?;
            tail.append_bytes(&first).map_err(&failed)?;
            sync_folder(path);
        } else {
            tail.cut_torn_end().map_err(&failed)?;
        }
        Ok(Self { lines: CommitQueue::start("recording", path, tail)?, path: path.to_owned() })
    }

    /// Writes a line, and returns once it is on disk.
    pub(super) fn write_line(&self, entry: &ChunkEntry) -> Result<(), LedgerError> {
        self.lines.write_and_wait(self.encode_line(entry)?)
    }

    /// Writes a line with the next write that succeeds, and does not wait for it.
    pub(super) fn queue_line(&self, entry: &ChunkEntry) {
        if let Ok(line) = self.encode_line(entry) {
            self.lines.queue_write(line);
        }
    }

    /// Returns once all earlier lines are on disk.
    pub(super) fn flush(&self) -> Result<(), LedgerError> {
        self.lines.write_and_wait(Vec::new())
    }

    /// The bytes of a line. An entry that would be too long to be read back is an error.
    fn encode_line(&self, entry: &ChunkEntry) -> Result<Vec<u8>, LedgerError> {
        let failed = LedgerError::io_error(&self.path, "write the recording");
        let line = entry.to_line().map_err(|error| failed(error.into()))?;
        if line.len() as u64 > MAX_LINE_BYTES {
            return Err(failed(io::Error::new(io::ErrorKind::InvalidData, "a call is too long to be kept")));
        }
        Ok(line)
    }
}

/// A file of a chunk, open for appending after its intact lines.
struct ChunkFileTail {
    file: File,
    place: LedgerLocation,
    /// How many bytes from the beginning are intact lines.
    sound: u64,
    /// Whether the file may have other bytes behind the intact lines.
    is_torn: bool,
}

impl ChunkFileTail {
    /// Cuts off the bytes that a crash or a failed write has left behind the intact lines.
    fn cut_torn_end(&mut self) -> io::Result<()> {
        if self.is_torn {
            self.file.set_len(self.sound)?;
            self.file.seek(SeekFrom::Start(self.sound))?;
            self.is_torn = false;
        }
        Ok(())
    }

    /// Appends bytes, and returns once they are on disk.
    fn append_bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.cut_torn_end()?;
        let written = self.file.write_all(bytes).and_then(|()| self.file.sync_data());
        self.is_torn = written.is_err();
        self.sound += if written.is_ok() { bytes.len() as u64 } else { 0 };
        written
    }
}

impl GroupCommit for ChunkFileTail {
    type Write = Vec<u8>;
    type Outcome = ();

    fn commit_group(&mut self, lines: &[Vec<u8>]) -> Result<Vec<()>, LedgerError> {
        let bytes = lines.concat();
        if !bytes.is_empty() {
            self.append_bytes(&bytes).map_err(LedgerError::io_error(self.place.clone(), "write the recording"))?;
        }
        Ok(vec![(); lines.len()])
    }

    fn finish(self) {}
}

/// Makes the name of a new file survive a loss of power, by syncing its folder. File systems that do not support this do not need it.
fn sync_folder(path: &Path) {
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}

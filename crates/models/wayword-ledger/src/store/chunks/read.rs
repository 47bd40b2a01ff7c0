//! Reads a chunk's file, and finds out where its intact part ends.

use super::line::{CHUNK_LINE_FORMAT, ChunkEntry};
use crate::{LedgerError, recording::MAX_LINE_BYTES};
use std::{
    fs::File,
    io::{BufRead, BufReader, ErrorKind, Read},
    path::Path,
};

/// Passes every entry of a file to `take`, and returns how many bytes of it are intact. The rest is an incomplete write, which a crash
/// can leave; it was never acknowledged, so it can be cut off. A file that does not exist counts as empty.
///
/// # Errors
/// When the file cannot be read, is no chunk's file, or a line was changed.
pub(super) fn read_entries(path: &Path, mut take: impl FnMut(ChunkEntry)) -> Result<u64, LedgerError> {
    let failed = LedgerError::io_error(path, "read the recording");
    let mut reader = match File::open(path) {
        Ok(file) => BufReader::new(file),
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(0),
        Err(error) => return Err(failed(error)),
    };
    let mut bytes = Vec::new();
    let mut sound = 0;
    for line in 1.. {
        let broken = |reason: String| LedgerError::Chunk { path: path.to_owned(), line, reason };
        if !read_next_line(&mut reader, &mut bytes).map_err(&failed)? {
            break;
        }
        if bytes.len() as u64 > MAX_LINE_BYTES {
            return Err(broken(format!("it is longer than {} MiB", MAX_LINE_BYTES >> 20)));
        }
        if bytes.last() != Some(&b'\n') {
            break;
        }
        match ChunkEntry::from_line(&bytes) {
            Ok(ChunkEntry::Ledger { format: CHUNK_LINE_FORMAT }) if line == 1 => {}
            Ok(ChunkEntry::Ledger { format }) if line == 1 => {
                return Err(broken(format!("a newer version of this program wrote it (format {format})")));
            }
            Ok(_) if line == 1 => return Err(broken("it does not begin as a recording in chunks".to_owned())),
            Ok(entry) => take(entry),
            // A power cut can leave zeros where the last write was to be.
            Err(_) if bytes.contains(&0) && is_all_torn(&mut reader, &mut bytes).map_err(&failed)? => break,
            Err(reason) => return Err(broken(reason)),
        }
        sound += bytes.len() as u64;
    }
    Ok(sound)
}

/// Reads the next line, or the beginning of one that is too long. Returns whether there is one.
fn read_next_line(reader: &mut BufReader<File>, bytes: &mut Vec<u8>) -> std::io::Result<bool> {
    bytes.clear();
    reader.by_ref().take(MAX_LINE_BYTES + 1).read_until(b'\n', bytes)?;
    Ok(!bytes.is_empty())
}

/// Whether none of the following lines is intact.
fn is_all_torn(reader: &mut BufReader<File>, bytes: &mut Vec<u8>) -> std::io::Result<bool> {
    while read_next_line(reader, bytes)? {
        if ChunkEntry::from_line(bytes).is_ok() {
            return Ok(false);
        }
    }
    Ok(true)
}

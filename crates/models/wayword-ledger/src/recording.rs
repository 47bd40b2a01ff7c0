//! Reads a recording of calls for a replay: the lines of an export, or of a chunk's file.

use crate::{LedgerEntry, LedgerError, store::ChunkEntry};
use std::{
    fs::File,
    io::{BufRead, BufReader, Read},
    path::Path,
};

/// Longest line of a recording, bytes. A longer line is refused when it is read or written.
pub(crate) const MAX_LINE_BYTES: u64 = 16 << 20;

/// Passes every call of a recording to `take`. The lines may come from a run, an export or a worker.
pub(crate) fn read_recording(path: &Path, take: impl Fn(LedgerEntry)) -> Result<(), LedgerError> {
    let failed = LedgerError::io_error(path, "read the recording");
    let mut reader = BufReader::new(File::open(path).map_err(&failed)?);
    let mut bytes = Vec::new();
    let mut is_chunk = false;
    for line in 1.. {
        let broken = |reason: String| LedgerError::Recording { path: path.to_owned(), line, reason };
        bytes.clear();
        reader.by_ref().take(MAX_LINE_BYTES + 1).read_until(b'\n', &mut bytes).map_err(&failed)?;
        // A chunk's file may end in the middle of a line, because its worker crashed or is still writing. That line is not used.
        let is_torn = is_chunk && bytes.last() != Some(&b'\n');
        if bytes.is_empty() || is_torn {
            break;
        }
        if bytes.len() as u64 > MAX_LINE_BYTES {
            return Err(broken(format!("it is longer than {} MiB", MAX_LINE_BYTES >> 20)));
        }
        if ChunkEntry::is_line(&bytes) {
            is_chunk = true;
            if let ChunkEntry::Answered { row, .. } = ChunkEntry::from_line(&bytes).map_err(broken)? {
                take(*row);
            }
            continue;
        }
        let row: LedgerEntry = serde_json::from_slice(&bytes).map_err(|error| broken(error.to_string()))?;
        if row.call.key() != row.key {
            return Err(broken("its key does not match its call, so the line was changed by hand".to_owned()));
        }
        take(row);
    }
    Ok(())
}

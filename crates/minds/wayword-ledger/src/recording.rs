//! Reads a recording: the lines that a run or an export wrote.

use crate::{LedgerError, call::Row};
use std::{
    fs::File,
    io::{BufRead, BufReader, Read},
    path::Path,
};

/// Longest line that is read, bytes.
const MOST_LINE_BYTES: u64 = 16 << 20;

/// Hands every row of a recording to `take`.
pub(crate) fn each(path: &Path, mut take: impl FnMut(Row) -> Result<(), LedgerError>) -> Result<(), LedgerError> {
    let failed = LedgerError::io(path, "read the recording");
    let mut reader = BufReader::new(File::open(path).map_err(&failed)?);
    let mut bytes = Vec::new();
    for line in 1.. {
        let broken = |reason: String| LedgerError::Recording { path: path.to_owned(), line, reason };
        bytes.clear();
        reader.by_ref().take(MOST_LINE_BYTES + 1).read_until(b'\n', &mut bytes).map_err(&failed)?;
        if bytes.is_empty() {
            break;
        }
        if bytes.len() as u64 > MOST_LINE_BYTES {
            return Err(broken(format!("it is longer than {} MiB", MOST_LINE_BYTES >> 20)));
        }
        let row: Row = serde_json::from_slice(&bytes).map_err(|error| broken(error.to_string()))?;
        if row.call.key() != row.key {
            return Err(broken("its key does not fit its call: it was changed by hand".to_owned()));
        }
        take(row)?;
    }
    Ok(())
}

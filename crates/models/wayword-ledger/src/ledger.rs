//! A ledger: a file, or one in memory, or one that answers from a recording alone.

use crate::{
    LedgerError, Row,
    flight::Flights,
    store::{Sqlite, Store, may_hold},
};
use std::{
    fs::File,
    io::{BufRead, BufReader, Read},
    path::{Path, PathBuf},
    sync::Arc,
    time::{SystemTime, UNIX_EPOCH},
};

/// Longest line of a recording that is read, bytes.
const MOST_LINE_BYTES: u64 = 16 << 20;

/// The calls of all runs. Clones share one ledger. When the last clone is dropped, all pending writes are finished.
#[derive(Debug, Clone)]
pub struct Ledger {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    store: Box<dyn Store>,
    flights: Flights,
    /// In a replay: the recording that all answers have to come from.
    recording: Option<PathBuf>,
}

impl Ledger {
    /// Opens a ledger, or makes one that only its owner can read. Several programs on one machine may have it open.
    ///
    /// # Errors
    /// When the file is not a ledger, is on a network file system, or cannot be read and written.
    pub fn open(path: &Path) -> Result<Self, LedgerError> {
        Ok(Self::of(Sqlite::open(path)?, None))
    }

    /// Checks whether a ledger may be kept at a path. Opens and makes nothing.
    ///
    /// # Errors
    /// When the path is on a network file system.
    pub fn check_place(path: &Path) -> Result<(), LedgerError> {
        may_hold(path)
    }

    /// A ledger in memory, which ends with the process.
    ///
    /// # Errors
    /// When there is not enough memory.
    pub fn in_memory() -> Result<Self, LedgerError> {
        Ok(Self::of(Sqlite::in_memory()?, None))
    }

    /// A ledger that takes all answers from a recording.
    ///
    /// # Errors
    /// When the recording cannot be read.
    pub fn replay(recording: &Path) -> Result<Self, LedgerError> {
        let store = Sqlite::in_memory()?;
        read(recording, |row| store.fill(row))?;
        store.flush()?;
        Ok(Self::of(store, Some(recording.to_owned())))
    }

    fn of(store: impl Store + 'static, recording: Option<PathBuf>) -> Self {
        Self { inner: Arc::new(Inner { store: Box::new(store), flights: Flights::default(), recording }) }
    }

    pub(crate) fn store(&self) -> &dyn Store {
        &*self.inner.store
    }

    pub(crate) fn flights(&self) -> &Flights {
        &self.inner.flights
    }

    pub(crate) fn recording(&self) -> Option<&Path> {
        self.inner.recording.as_deref()
    }
}

/// Passes every row of a recording to `take`. A run or an export wrote these lines.
fn read(path: &Path, take: impl Fn(Row)) -> Result<(), LedgerError> {
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
            return Err(broken("its key does not match its call, so the line was changed by hand".to_owned()));
        }
        take(row);
    }
    Ok(())
}

/// Seconds since 1970.
pub(crate) fn now_unix_s() -> i64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| i64::try_from(since.as_secs()).unwrap_or(i64::MAX))
}

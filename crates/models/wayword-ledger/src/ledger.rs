//! The type [`Ledger`], and the ways to open one: a file, memory, a recording, recordings of chunks, or a database.

#[cfg(feature = "postgres")]
use crate::store::{LeaseTiming, PostgresStore};
use crate::{
    LedgerError, RunSpending,
    flight::CallFlights,
    recording,
    store::{CallStore, ChunkStore, SqliteStore, check_place, spent_in},
};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
    time::{SystemTime, UNIX_EPOCH},
};

/// The calls of all runs. Clones share one ledger. When the last clone is dropped, all pending writes are finished.
#[derive(Debug, Clone)]
pub struct Ledger {
    inner: Arc<LedgerState>,
}

#[derive(Debug)]
struct LedgerState {
    store: Box<dyn CallStore>,
    flights: CallFlights,
    /// In a replay: the recording from which all answers have to come.
    recording: Option<PathBuf>,
}

impl Ledger {
    /// Opens a ledger, or makes one that only its owner can read. Several programs on one machine may have it open.
    ///
    /// # Errors
    /// When the file is not a ledger, is on a network file system, or cannot be read and written.
    pub fn open(path: &Path) -> Result<Self, LedgerError> {
        Ok(Self::from_store(SqliteStore::open(path)?, None))
    }

    /// Checks whether a ledger may be kept at a path. It neither opens nor creates a file.
    ///
    /// # Errors
    /// When the path is no file, or is on a network file system.
    pub fn check_place(path: &Path) -> Result<(), LedgerError> {
        check_place(path)
    }

    /// A ledger in memory, which ends with the process.
    ///
    /// # Errors
    /// When there is not enough memory.
    pub fn in_memory() -> Result<Self, LedgerError> {
        Ok(Self::from_store(SqliteStore::in_memory()?, None))
    }

    /// A ledger in memory that takes all answers from a recording. A call that the recording does not have is an error.
    ///
    /// # Errors
    /// When the recording cannot be read.
    pub fn replay_recording(recording: &Path) -> Result<Self, LedgerError> {
        let store = SqliteStore::in_memory()?;
        recording::read_recording(recording, |row| store.add_recorded_answer(row))?;
        store.flush()?;
        Ok(Self::from_store(store, Some(recording.to_owned())))
    }

    /// A ledger of one shard of a run. The chunks of the shard are made one after the other, and each has one file, to which requests
    /// and answers are appended; it may be on a network file system. The limits of a run hold over all chunks together. `earlier` are
    /// the files of the other chunks: their spending counts, and their answers are not used. A file that does not exist counts as
    /// empty.
    ///
    /// Call [`Ledger::turn_to`] before the first call. The caller has to make sure that only one program at a time writes a file.
    ///
    /// # Errors
    /// When a file cannot be read, or was changed.
    pub fn in_chunks(earlier: &[PathBuf]) -> Result<Self, LedgerError> {
        Ok(Self::from_store(ChunkStore::open(earlier)?, None))
    }

    /// Goes on with the file of another chunk, or makes it. The answers of the previous chunk are no longer found. An incomplete last
    /// line, which a crash can leave, is cut off: its request had not been sent, or its answer had not been used.
    ///
    /// Only for a ledger of [`Ledger::in_chunks`], between the calls of one chunk and those of the next.
    ///
    /// # Errors
    /// When calls are in flight, the file cannot be read and written, or a line was changed.
    pub fn turn_to(&self, file: &Path) -> Result<(), LedgerError> {
        let turned = self.flights().run_while_idle(|| self.store().turn_to(file));
        turned.unwrap_or_else(|| {
            let reason = "it cannot be left for another chunk while calls are in flight";
            Err(LedgerError::Misuse { place: self.store().ledger_location(), reason })
        })
    }

    /// Sums up the spending in the file of a chunk. It only reads, so another program may be writing the file. A file that does not
    /// exist counts as empty.
    ///
    /// # Errors
    /// When the file cannot be read, or was changed.
    pub fn spent_in(file: &Path) -> Result<RunSpending, LedgerError> {
        spent_in(file)
    }

    /// A ledger in a database, which programs on any number of machines share: each call is made once, the limits of a
    /// run hold for all of them together, and so do rates ([`crate::LedgerRun::wait_turn`]). Makes the tables
    /// ([`crate::LEDGER_TABLES`]) if it may and they are missing.
    ///
    /// # Errors
    /// When the database cannot be used, or its tables are missing and this role may not make them.
    #[cfg(feature = "postgres")]
    pub fn open_postgres(database: &wayword_database::PostgresDatabase) -> Result<Self, LedgerError> {
        Self::postgres_with_lease(database, LeaseTiming::DEFAULT_LEASE)
    }

    /// The same with another lease: a program without a sign of life for that long counts as ended, and others may make its calls. All
    /// programs have to use the same lease; [`Ledger::open_postgres`] uses one minute.
    ///
    /// # Errors
    /// As [`Ledger::open_postgres`].
    #[cfg(feature = "postgres")]
    pub fn postgres_with_lease(
        database: &wayword_database::PostgresDatabase,
        lease: std::time::Duration,
    ) -> Result<Self, LedgerError> {
        Ok(Self::from_store(PostgresStore::open(database, LeaseTiming::from_lease(lease))?, None))
    }

    fn from_store(store: impl CallStore + 'static, recording: Option<PathBuf>) -> Self {
        Self { inner: Arc::new(LedgerState { store: Box::new(store), flights: CallFlights::default(), recording }) }
    }

    pub(crate) fn store(&self) -> &dyn CallStore {
        &*self.inner.store
    }

    pub(crate) fn flights(&self) -> &CallFlights {
        &self.inner.flights
    }

    pub(crate) fn recording(&self) -> Option<&Path> {
        self.inner.recording.as_deref()
    }
}

/// Seconds since 1970.
pub(crate) fn now_unix_s() -> i64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| i64::try_from(since.as_secs()).unwrap_or(i64::MAX))
}

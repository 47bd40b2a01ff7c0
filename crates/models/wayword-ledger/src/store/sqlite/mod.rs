//! A store in a file of SQLite, which programs on one machine share, or in memory.

mod presence;
mod queries;
mod schema;
mod writer;

use super::{CallStore, ClaimHolder, ClaimState, PendingRequest, RequestEnd, SentRequest};
use crate::{CallAnswer, CallKey, LedgerEntry, LedgerError, LedgerLocation, RequestRefusedError, network_at};
use presence::PresenceFile;
use rusqlite::{Connection, OpenFlags, OptionalExtension, params};
use std::{
    fs,
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, OnceLock, PoisonError},
    time::Duration,
};

use writer::{LedgerWrite, LedgerWriter};

/// How long SQLite waits for another program that is writing.
const BUSY_TIMEOUT: Duration = Duration::from_secs(30);

/// A ledger's file, with one connection for reading and one thread for writing.
#[derive(Debug)]
pub(crate) struct SqliteStore {
    path: PathBuf,
    reader: Mutex<Connection>,
    writer: LedgerWriter,
    /// Shows other programs that this one is running, from its first claim on. It is dropped after the writer, because
    /// the writer releases the claims.
    presence: OnceLock<Result<PresenceFile, LedgerError>>,
    /// Whether other programs may have the ledger open: true for a file, false for memory.
    is_shared: bool,
}

impl SqliteStore {
    /// Opens the ledger in a file, or makes it.
    pub(crate) fn open(path: &Path) -> Result<Self, LedgerError> {
        // SQLite gives names such as ":memory:" a special meaning. An absolute path is always a file.
        let path = &std::path::absolute(path).map_err(LedgerError::io_error(path, "find the ledger"))?;
        check_place(path)?;
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            fs::create_dir_all(folder).map_err(LedgerError::io_error(folder, "make the folder"))?;
        }
        make_private_file(path)?;
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let connect = || -> Result<Connection, LedgerError> {
            let connection =
                Connection::open_with_flags(path, flags).map_err(LedgerError::store_error(path, "open"))?;
            connection.busy_timeout(BUSY_TIMEOUT).map_err(LedgerError::store_error(path, "open"))?;
            Ok(connection)
        };
        let mut writing = connect()?;
        schema::prepare_tables(&mut writing, path)?;
        let (reader, writer) = (Mutex::new(connect()?), LedgerWriter::for_connection(writing, path)?);
        Ok(Self { path: path.to_owned(), reader, writer, presence: OnceLock::new(), is_shared: true })
    }

    /// A ledger in memory, which ends with the process. Its connections share it by a unique name.
    pub(crate) fn in_memory() -> Result<Self, LedgerError> {
        use std::sync::atomic::{AtomicU64, Ordering};
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        let path = PathBuf::from("memory");
        let name = format!(
            "file:ledger-{}-{}?mode=memory&cache=shared",
            std::process::id(),
            NUMBER.fetch_add(1, Ordering::Relaxed)
        );
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_CREATE | OpenFlags::SQLITE_OPEN_URI;
        let connect = || Connection::open_with_flags(&name, flags).map_err(LedgerError::store_error(&path, "open"));
        let mut writing = connect()?;
        schema::prepare_tables(&mut writing, &path)?;
        let reader = connect()?;
        // Otherwise connections that share a cache would lock each other out.
        reader.pragma_update(None, "read_uncommitted", true).map_err(LedgerError::store_error(&path, "open"))?;
        let (reader, writer) = (Mutex::new(reader), LedgerWriter::for_connection(writing, &path)?);
        Ok(Self { path, reader, writer, presence: OnceLock::new(), is_shared: false })
    }

    fn lock_reader(&self) -> MutexGuard<'_, Connection> {
        self.reader.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The name under which other programs know this one; `None` for a ledger in memory, which has no other programs.
    /// The first call also removes the files and claims of programs that have ended.
    fn program_name(&self) -> Result<Option<&str>, LedgerError> {
        if !self.is_shared {
            return Ok(None);
        }
        let begin = || {
            let presence = PresenceFile::new(&self.path)?;
            for ended_program in presence::remove_stale_files(&self.path) {
                self.writer.queue_write(LedgerWrite::Forget { by: ended_program });
            }
            Ok(presence)
        };
        match self.presence.get_or_init(begin) {
            Ok(presence) => Ok(Some(presence.name())),
            Err(error) => Err(error.clone()),
        }
    }

    /// The name under which other programs know this one, for a write.
    fn owned_program_name(&self) -> Result<Option<String>, LedgerError> {
        Ok(self.program_name()?.map(str::to_owned))
    }

    /// Adds an answer that was read from a recording.
    pub(crate) fn add_recorded_answer(&self, row: LedgerEntry) {
        self.writer.queue_write(LedgerWrite::Answered { sent: None, row: Box::new(row), by: None });
    }

    /// The answer of a call, if it has one.
    fn read_answer(&self, key: &CallKey) -> Result<Option<CallAnswer>, LedgerError> {
        let failed = LedgerError::store_error(&self.path, "read");
        let reader = self.lock_reader();
        let sql = format!("SELECT {} FROM calls WHERE key = ?1", schema::CALL_COLUMNS);
        let mut statement = reader.prepare_cached(&sql).map_err(&failed)?;
        let mut rows = statement.query(params![key.as_str()]).map_err(&failed)?;
        let Some(row) = rows.next().map_err(&failed)? else { return Ok(None) };
        Ok(Some(schema::read_checked_entry(row, &self.path)?.answer))
    }
}

impl CallStore for SqliteStore {
    fn ledger_location(&self) -> LedgerLocation {
        LedgerLocation::from_path(&self.path)
    }

    fn find_answer(&self, key: &CallKey, run: &str) -> Result<Option<CallAnswer>, LedgerError> {
        let answer = self.read_answer(key)?;
        if answer.is_some() {
            self.writer.queue_write(LedgerWrite::Used { run: run.to_owned(), key: key.to_string() });
        }
        Ok(answer)
    }

    fn claim_call(&self, key: &CallKey, from: Option<&str>) -> Result<ClaimState, LedgerError> {
        let Some(by) = self.owned_program_name()? else { return Ok(ClaimState::Ours) };
        let written = self.writer.write_and_wait(LedgerWrite::Claim {
            key: key.to_string(),
            by,
            from: from.map(str::to_owned),
        })?;
        Ok(writer::claim_from_number(written))
    }

    fn release_call(&self, key: &CallKey) {
        if let Ok(Some(by)) = self.owned_program_name() {
            self.writer.queue_write(LedgerWrite::Release { key: key.to_string(), by });
        }
    }

    fn claim_holder(&self, key: &CallKey) -> Result<Option<ClaimHolder>, LedgerError> {
        let failed = LedgerError::store_error(&self.path, "read");
        let holder = {
            let reader = self.lock_reader();
            let mut statement =
                reader.prepare_cached("SELECT holder, sent FROM claims WHERE key = ?1").map_err(&failed)?;
            let holder = |row: &rusqlite::Row<'_>| Ok((row.get(0)?, row.get(1)?));
            statement.query_row(params![key.as_str()], holder).optional().map_err(&failed)?
        };
        Ok(holder.map(|(name, sent): (String, i64)| {
            let is_gone = presence::is_gone(&self.path, &name);
            ClaimHolder { name, sent, is_gone }
        }))
    }

    fn write_request(&self, request: &PendingRequest<'_>) -> Result<i64, RequestRefusedError> {
        let PendingRequest { run, key, most_usd, at_unix_s: at, .. } = *request;
        let by = self.owned_program_name()?;
        let write = LedgerWrite::Sent { run: run.to_owned(), key: key.to_string(), most_usd, at, by };
        Ok(self.writer.write_and_wait(write)?)
    }

    fn write_end(&self, sent: &SentRequest, end: RequestEnd, reason: &str) {
        self.writer.queue_write(LedgerWrite::Ended {
            sent: sent.number,
            outcome: end.name(),
            reason: reason.to_owned(),
        });
    }

    fn write_answer(&self, sent: Option<&SentRequest>, row: LedgerEntry) -> Result<bool, LedgerError> {
        let (sent, by) = (sent.map(|sent| sent.number), self.owned_program_name()?);
        Ok(self.writer.write_and_wait(LedgerWrite::Answered { sent, row: Box::new(row), by })? != 0)
    }

    fn flush(&self) -> Result<(), LedgerError> {
        self.writer.flush()
    }
}

/// Refuses a path that is no file, or lies on a file system on which the database is not reliable.
pub(crate) fn check_place(path: &Path) -> Result<(), LedgerError> {
    if fs::metadata(path).is_ok_and(|about| !about.is_file()) {
        return Err(LedgerError::NotAFile(path.to_owned()));
    }
    match network_at(path) {
        Some(kind) => Err(LedgerError::Network { path: path.to_owned(), kind }),
        None => Ok(()),
    }
}

/// Makes the file if it does not exist. Only its owner can read it, because prompts may be private.
fn make_private_file(path: &Path) -> Result<(), LedgerError> {
    let mut options = fs::OpenOptions::new();
    options.create(true).append(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options.open(path).map(drop).map_err(LedgerError::io_error(path, "make the ledger"))
}

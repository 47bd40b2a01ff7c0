//! The database file.

mod schema;
mod writer;

use crate::{Answer, Key, LedgerError, budget::Spent, call::Row, network_at};
use rusqlite::{Connection, OpenFlags, OptionalExtension, params};
use std::{
    fs,
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
    time::Duration,
};

pub(crate) use schema::{COLUMNS, row};
pub(crate) use writer::{Write, Writer};

/// How long one program waits for another that writes.
const PATIENCE: Duration = Duration::from_secs(30);

/// A ledger's file: one connection that reads, one thread that writes.
#[derive(Debug)]
pub(crate) struct Store {
    path: PathBuf,
    reader: Mutex<Connection>,
    pub(crate) writer: Writer,
}

impl Store {
    pub(crate) fn open(path: &Path) -> Result<Self, LedgerError> {
        // The database gives names such as ":memory:" a meaning of their own, unless they are those of files beyond doubt.
        let path = &std::path::absolute(path).map_err(LedgerError::io(path, "find the ledger"))?;
        may_hold(path)?;
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            fs::create_dir_all(folder).map_err(LedgerError::io(folder, "make the folder"))?;
        }
        own_file(path)?;
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let connect = || -> Result<Connection, LedgerError> {
            let connection = Connection::open_with_flags(path, flags).map_err(LedgerError::store(path, "open"))?;
            connection.busy_timeout(PATIENCE).map_err(LedgerError::store(path, "open"))?;
            Ok(connection)
        };
        let mut writing = connect()?;
        schema::prepare(&mut writing, path)?;
        Ok(Self { path: path.to_owned(), reader: Mutex::new(connect()?), writer: Writer::start(writing, path)? })
    }

    /// A ledger that is gone with the process; the connections share it by a name of its own.
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
        let connect = || Connection::open_with_flags(&name, flags).map_err(LedgerError::store(&path, "open"));
        let mut writing = connect()?;
        schema::prepare(&mut writing, &path)?;
        let reader = connect()?;
        // Connections that share a cache would otherwise lock each other out.
        reader.pragma_update(None, "read_uncommitted", true).map_err(LedgerError::store(&path, "open"))?;
        Ok(Self { reader: Mutex::new(reader), writer: Writer::start(writing, &path)?, path })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn reader(&self) -> MutexGuard<'_, Connection> {
        self.reader.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The answer of a call, where it has one.
    pub(crate) fn answer(&self, key: &Key) -> Result<Option<Answer>, LedgerError> {
        let failed = LedgerError::store(&self.path, "read");
        let reader = self.reader();
        let sql = format!("SELECT {} FROM calls WHERE key = ?1", schema::COLUMNS);
        let mut statement = reader.prepare_cached(&sql).map_err(&failed)?;
        let row = statement.query_row(params![key.as_str()], schema::row).optional().map_err(&failed)?;
        Ok(row.map(|row: Row| row.answer))
    }

    /// What a run has spent so far: what was paid, and upper bounds of what may have been.
    pub(crate) fn spent(&self, run: &str) -> Result<Spent, LedgerError> {
        let failed = LedgerError::store(&self.path, "read");
        self.writer.flush()?;
        let reader = self.reader();
        let sql = "SELECT TOTAL(CASE WHEN outcome = 'answered' THEN COALESCE(usd, most_usd)
                                     WHEN outcome IS NULL OR outcome = 'lost' THEN most_usd END),
                   COUNT(*) FROM sent WHERE run = ?1 AND outcome IS NOT 'cancelled'";
        let spent =
            reader.query_row(sql, params![run], |row| Ok((row.get(0)?, row.get::<_, i64>(1)?))).map_err(&failed)?;
        Ok(Spent { usd: spent.0, reserved_usd: 0.0, calls: u64::try_from(spent.1).unwrap_or(0) })
    }
}

/// Refuses a place where the database cannot rely on the file system.
pub(crate) fn may_hold(path: &Path) -> Result<(), LedgerError> {
    match network_at(path) {
        Some(kind) => Err(LedgerError::Network { path: path.to_owned(), kind }),
        None => Ok(()),
    }
}

/// Makes the file where there is none, for its owner's eyes alone: prompts may be private.
fn own_file(path: &Path) -> Result<(), LedgerError> {
    let mut options = fs::OpenOptions::new();
    options.create(true).append(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options.open(path).map(drop).map_err(LedgerError::io(path, "make the ledger"))
}

//! The database file.

mod presence;
mod schema;
mod writer;

use crate::{Answer, Key, LedgerError, budget::Spent, network_at};
use presence::Presence;
use rusqlite::{Connection, OpenFlags, OptionalExtension, params};
use std::{
    fs,
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, OnceLock, PoisonError},
    time::Duration,
};

pub(crate) use schema::{COLUMNS, sound};
pub(crate) use writer::{Claimed, Write, Writer};

/// How long this program waits for another one that writes.
const PATIENCE: Duration = Duration::from_secs(30);

/// A ledger's file: one connection that reads, one thread that writes.
#[derive(Debug)]
pub(crate) struct Store {
    path: PathBuf,
    reader: Mutex<Connection>,
    pub(crate) writer: Writer,
    /// Shows other programs that this one is running, from its first claim on. It is dropped after the writer, because
    /// the writer releases the claims.
    presence: OnceLock<Result<Presence, LedgerError>>,
    is_shared: bool,
}

/// The program that is making a call.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Holder {
    /// The name of the program.
    pub(crate) name: String,
    /// How many requests it has sent for the call.
    pub(crate) sent: i64,
}

impl Store {
    pub(crate) fn open(path: &Path) -> Result<Self, LedgerError> {
        // SQLite gives names such as ":memory:" a special meaning. An absolute path is always a file.
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
        let (reader, writer) = (Mutex::new(connect()?), Writer::start(writing, path)?);
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
        let connect = || Connection::open_with_flags(&name, flags).map_err(LedgerError::store(&path, "open"));
        let mut writing = connect()?;
        schema::prepare(&mut writing, &path)?;
        let reader = connect()?;
        // Otherwise connections that share a cache would lock each other out.
        reader.pragma_update(None, "read_uncommitted", true).map_err(LedgerError::store(&path, "open"))?;
        let (reader, writer) = (Mutex::new(reader), Writer::start(writing, &path)?);
        Ok(Self { path, reader, writer, presence: OnceLock::new(), is_shared: false })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn reader(&self) -> MutexGuard<'_, Connection> {
        self.reader.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The answer of a call, if it has one.
    pub(crate) fn answer(&self, key: &Key) -> Result<Option<Answer>, LedgerError> {
        let failed = LedgerError::store(&self.path, "read");
        let reader = self.reader();
        let sql = format!("SELECT {} FROM calls WHERE key = ?1", schema::COLUMNS);
        let mut statement = reader.prepare_cached(&sql).map_err(&failed)?;
        let mut rows = statement.query(params![key.as_str()]).map_err(&failed)?;
        let Some(row) = rows.next().map_err(&failed)? else { return Ok(None) };
        Ok(Some(schema::sound(row, &self.path)?.answer))
    }

    /// The name under which other programs know this one; `None` for a ledger in memory, which has no other programs.
    /// The first call also removes what ended programs left behind.
    pub(crate) fn name(&self) -> Result<Option<&str>, LedgerError> {
        if !self.is_shared {
            return Ok(None);
        }
        let begin = || {
            let presence = Presence::new(&self.path)?;
            for by in presence::sweep(&self.path) {
                self.writer.note(Write::Forget { by });
            }
            Ok(presence)
        };
        match self.presence.get_or_init(begin) {
            Ok(presence) => Ok(Some(presence.name())),
            Err(error) => Err(error.clone()),
        }
    }

    /// The program that is making a call at the moment.
    pub(crate) fn holder(&self, key: &Key) -> Result<Option<Holder>, LedgerError> {
        let failed = LedgerError::store(&self.path, "read");
        let reader = self.reader();
        let mut statement = reader.prepare_cached("SELECT holder, sent FROM claims WHERE key = ?1").map_err(&failed)?;
        let holder = |row: &rusqlite::Row<'_>| Ok(Holder { name: row.get(0)?, sent: row.get(1)? });
        statement.query_row(params![key.as_str()], holder).optional().map_err(&failed)
    }

    /// Whether the program of that name has ended.
    pub(crate) fn is_gone(&self, name: &str) -> bool {
        presence::is_gone(&self.path, name)
    }

    /// What a run has spent so far: what was paid, plus the upper bounds of requests that may have been paid.
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

/// Refuses a path on a file system on which the database is not reliable.
pub(crate) fn may_hold(path: &Path) -> Result<(), LedgerError> {
    match network_at(path) {
        Some(kind) => Err(LedgerError::Network { path: path.to_owned(), kind }),
        None => Ok(()),
    }
}

/// Makes the file if it does not exist. Only its owner can read it, because prompts may be private.
fn own_file(path: &Path) -> Result<(), LedgerError> {
    let mut options = fs::OpenOptions::new();
    options.create(true).append(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options.open(path).map(drop).map_err(LedgerError::io(path, "make the ledger"))
}

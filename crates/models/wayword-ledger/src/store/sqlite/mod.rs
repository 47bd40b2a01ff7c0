//! A store in a file of SQLite, which programs on one machine share, or in memory.

mod presence;
mod queries;
mod schema;
mod writer;

use super::{Claimed, End, Holder, Request, Store};
use crate::{Answer, Key, LedgerError, Place, Refused, Row, network_at, run::Sent};
use presence::Presence;
use rusqlite::{Connection, OpenFlags, OptionalExtension, params};
use std::{
    fs,
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, OnceLock, PoisonError},
    time::Duration,
};

use writer::{Write, Writer};

/// How long SQLite waits for another program that is writing.
const PATIENCE: Duration = Duration::from_secs(30);

/// A ledger's file, with one connection for reading and one thread for writing.
#[derive(Debug)]
pub(crate) struct Sqlite {
    path: PathBuf,
    reader: Mutex<Connection>,
    writer: Writer,
    /// Shows other programs that this one is running, from its first claim on. It is dropped after the writer, because
    /// the writer releases the claims.
    presence: OnceLock<Result<Presence, LedgerError>>,
    is_shared: bool,
}

impl Sqlite {
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

    fn reader(&self) -> MutexGuard<'_, Connection> {
        self.reader.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The name under which other programs know this one; `None` for a ledger in memory, which has no other programs.
    /// The first call also removes the files and claims of programs that have ended.
    fn name(&self) -> Result<Option<&str>, LedgerError> {
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

    /// The name under which other programs know this one, for a write.
    fn by(&self) -> Result<Option<String>, LedgerError> {
        Ok(self.name()?.map(str::to_owned))
    }

    /// Adds an answer that was read from a recording.
    pub(crate) fn fill(&self, row: Row) {
        self.writer.note(Write::Answered { sent: None, row: Box::new(row), by: None });
    }

    /// The answer of a call, if it has one.
    fn find(&self, key: &Key) -> Result<Option<Answer>, LedgerError> {
        let failed = LedgerError::store(&self.path, "read");
        let reader = self.reader();
        let sql = format!("SELECT {} FROM calls WHERE key = ?1", schema::COLUMNS);
        let mut statement = reader.prepare_cached(&sql).map_err(&failed)?;
        let mut rows = statement.query(params![key.as_str()]).map_err(&failed)?;
        let Some(row) = rows.next().map_err(&failed)? else { return Ok(None) };
        Ok(Some(schema::sound(row, &self.path)?.answer))
    }
}

impl Store for Sqlite {
    fn place(&self) -> Place {
        Place::file(&self.path)
    }

    fn answer(&self, key: &Key, run: &str) -> Result<Option<Answer>, LedgerError> {
        let answer = self.find(key)?;
        if answer.is_some() {
            self.writer.note(Write::Used { run: run.to_owned(), key: key.to_string() });
        }
        Ok(answer)
    }

    fn claim(&self, key: &Key, from: Option<&str>) -> Result<Claimed, LedgerError> {
        let Some(by) = self.by()? else { return Ok(Claimed::Ours) };
        let written = self.writer.keep(Write::Claim { key: key.to_string(), by, from: from.map(str::to_owned) })?;
        Ok(writer::claimed(written))
    }

    fn release(&self, key: &Key) {
        if let Ok(Some(by)) = self.by() {
            self.writer.note(Write::Release { key: key.to_string(), by });
        }
    }

    fn holder(&self, key: &Key) -> Result<Option<Holder>, LedgerError> {
        let failed = LedgerError::store(&self.path, "read");
        let holder = {
            let reader = self.reader();
            let mut statement =
                reader.prepare_cached("SELECT holder, sent FROM claims WHERE key = ?1").map_err(&failed)?;
            let holder = |row: &rusqlite::Row<'_>| Ok((row.get(0)?, row.get(1)?));
            statement.query_row(params![key.as_str()], holder).optional().map_err(&failed)?
        };
        Ok(holder.map(|(name, sent): (String, i64)| {
            let is_gone = presence::is_gone(&self.path, &name);
            Holder { name, sent, is_gone }
        }))
    }

    fn sent(&self, request: &Request<'_>) -> Result<i64, Refused> {
        let Request { run, key, most_usd, at_unix_s: at, .. } = *request;
        let by = self.by()?;
        let write = Write::Sent { run: run.to_owned(), key: key.to_string(), most_usd, at, by };
        Ok(self.writer.keep(write)?)
    }

    fn ended(&self, sent: &Sent, end: End, reason: &str) {
        self.writer.note(Write::Ended { sent: sent.number, outcome: end.name(), reason: reason.to_owned() });
    }

    fn answered(&self, sent: Option<&Sent>, row: Row) -> Result<bool, LedgerError> {
        let (sent, by) = (sent.map(|sent| sent.number), self.by()?);
        Ok(self.writer.keep(Write::Answered { sent, row: Box::new(row), by })? != 0)
    }

    fn flush(&self) -> Result<(), LedgerError> {
        self.writer.flush()
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

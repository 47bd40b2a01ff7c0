//! The database of a study, one SQLite file with everything that participants gave. An answer is acknowledged to a participant only
//! when it is on disk.

mod answers;
mod assign;
mod counts;
mod people;
mod read;
mod recruits;
mod stage;

pub(crate) use answers::{InputRefusal, MAX_MOVES_PER_WALK, MAX_OWN_TEXT_CHARS, ParticipantInput};
pub use counts::{ConditionProgress, StudyProgress};
pub(crate) use people::{ArrivalOutcome, ParticipantArrival, WithdrawalChoice, may_be_issued};
pub use people::{ErasureReport, InviteTokens};
pub use recruits::{Reconciliation, ReconciliationRow};
pub(crate) use stage::{AnswerProgress, ParticipantStage, ParticipationOutcome, StoredSlot};

#[cfg(test)]
mod tests;

use crate::study::{Study, StudyError};
use rusqlite::{Connection, OpenFlags, TransactionBehavior};
use std::{
    path::{Path, PathBuf},
    time::{Duration, SystemTime, UNIX_EPOCH},
};

/// Makes the tables that do not exist yet.
const DATABASE_SCHEMA: &str = include_str!("schema.sql");
/// Version of the tables, which SQLite keeps as `user_version`. A database of a later version is refused.
const SCHEMA_VERSION: i64 = 1;
/// How long a command waits for another process that is writing. Then it fails.
const BUSY_TIMEOUT: Duration = Duration::from_secs(10);

/// The database of a study.
#[derive(Debug)]
pub(crate) struct StudyStore {
    db: Connection,
}

impl StudyStore {
    /// Opens the database, and makes it where there is none.
    ///
    /// # Errors
    /// When it cannot be opened, or is of a later version.
    pub(crate) fn open(file: &Path) -> Result<Self, StudyError> {
        // Opening a pipe would wait for ever.
        if std::fs::metadata(file).is_ok_and(|about| !about.is_file()) {
            return Err(StudyError::File {
                path: file.to_owned(),
                problem: "this is a folder, a pipe or a device, not a file".to_owned(),
                hint: "put back a copy of the study's folder",
            });
        }
        let db = Connection::open(file)?;
        db.busy_timeout(BUSY_TIMEOUT)?;
        db.pragma_update(None, "journal_mode", "WAL")?;
        // An answer that was acknowledged survives a loss of power.
        db.pragma_update(None, "synchronous", "FULL")?;
        db.pragma_update(None, "foreign_keys", true)?;
        // Deleted data are overwritten, and not only unlinked.
        db.pragma_update(None, "secure_delete", true)?;
        check_version(&db, file)?;
        db.execute_batch(DATABASE_SCHEMA)?;
        db.pragma_update(None, "user_version", SCHEMA_VERSION)?;
        Ok(Self { db })
    }

    /// A store in memory, which is gone when it is dropped.
    ///
    /// # Errors
    /// When there is no memory.
    pub(crate) fn open_in_memory() -> Result<Self, StudyError> {
        let db = Connection::open_in_memory()?;
        db.pragma_update(None, "foreign_keys", true)?;
        db.execute_batch(DATABASE_SCHEMA)?;
        Ok(Self { db })
    }

    /// Opens the database to read it. Nothing is written, so this works on a full disk and in a folder that cannot be written.
    ///
    /// # Errors
    /// When it cannot be opened, or is of a later version.
    pub(crate) fn open_to_read(file: &Path) -> Result<Self, StudyError> {
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX | OpenFlags::SQLITE_OPEN_URI;
        let open = |uri: &str| -> Result<Self, StudyError> {
            let db = Connection::open_with_flags(uri, flags)?;
            db.busy_timeout(BUSY_TIMEOUT)?;
            check_version(&db, file)?;
            let has_tables = "SELECT EXISTS (SELECT 1 FROM sqlite_master WHERE name = 'end_answers')";
            if db.query_row(has_tables, [], |row| row.get(0))? {
                return Ok(Self { db });
            }
            // An earlier version of the program made it, without the newer tables.
            drop(db);
            Self::open(file)
        };
        let address = file_uri(file);
        let opened = open(&address);
        // SQLite makes a file of shared memory beside the database, where no server has one. Without room for it, the database can still be
        // read as it is, unless its log has answers that only that file leads to.
        let log = PathBuf::from(format!("{}-wal", file.display()));
        let has_empty_log = std::fs::metadata(log).map_or(true, |log| log.len() == 0);
        match opened {
            Err(StudyError::Store { .. }) if file.exists() && has_empty_log => open(&format!("{address}?immutable=1")),
            opened => opened,
        }
    }

    /// Runs `work` as one transaction: all its changes are kept, or none.
    ///
    /// # Errors
    /// The error of `work`, or of SQLite.
    pub(crate) fn write_transaction<T>(
        &mut self,
        study: &Study,
        now_ms: i64,
        work: impl FnOnce(&StudyTransaction<'_>) -> Result<T, StudyError>,
    ) -> Result<T, StudyError> {
        let transaction = self.db.transaction_with_behavior(TransactionBehavior::Immediate)?;
        let done = work(&StudyTransaction { db: &transaction, study, now_ms })?;
        transaction.commit()?;
        Ok(done)
    }

    /// Runs `work` on a snapshot of the database, while others can go on writing.
    ///
    /// # Errors
    /// The error of `work`, or of SQLite.
    pub(crate) fn read_transaction<T>(
        &mut self,
        study: &Study,
        now_ms: i64,
        work: impl FnOnce(&StudyTransaction<'_>) -> Result<T, StudyError>,
    ) -> Result<T, StudyError> {
        let transaction = self.db.transaction_with_behavior(TransactionBehavior::Deferred)?;
        work(&StudyTransaction { db: &transaction, study, now_ms })
    }

    /// Empties the write-ahead log, so that deleted data remain nowhere on the disk. A concurrent reader can prevent this; then the next
    /// call does it.
    pub(crate) fn empty_log(&self) {
        let _ = self.db.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()));
    }

    /// Runs `work` for several requests as one transaction, with one wait for the disk. `work` returns for each request whether its
    /// changes are kept; a failed request does not undo the others.
    ///
    /// # Errors
    /// The error of SQLite; then no change at all is kept.
    pub(crate) fn write_batch<T>(
        &mut self,
        study: &Study,
        requests: impl Iterator<Item = T>,
        mut work: impl FnMut(T, &StudyTransaction<'_>) -> bool,
    ) -> Result<(), StudyError> {
        let mut transaction = self.db.transaction_with_behavior(TransactionBehavior::Immediate)?;
        for request in requests {
            let savepoint = transaction.savepoint()?;
            if work(request, &StudyTransaction { db: &savepoint, study, now_ms: now_ms() }) {
                savepoint.commit()?;
            } else {
                savepoint.finish()?;
            }
        }
        Ok(transaction.commit()?)
    }
}

/// Refuses a database of a later version of the program.
fn check_version(db: &Connection, file: &Path) -> Result<(), StudyError> {
    let version: i64 = db.pragma_query_value(None, "user_version", |row| row.get(0))?;
    if version > SCHEMA_VERSION {
        let problem = format!(
            "{}: a later version of this program made it (tables of version {version}, and this program reads {SCHEMA_VERSION})",
            file.display()
        );
        return Err(StudyError::refused_request(problem, "use that version"));
    }
    Ok(())
}

/// The address of a file as SQLite takes it, with the letters encoded that an address reserves.
fn file_uri(file: &Path) -> String {
    let path = file.to_string_lossy();
    format!("file:{}", path.replace('%', "%25").replace('?', "%3f").replace('#', "%23"))
}

/// Unix time, milliseconds.
#[must_use]
pub fn now_ms() -> i64 {
    let passed = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    i64::try_from(passed.as_millis()).unwrap_or(i64::MAX)
}

/// The database inside a transaction, with the time of the request. All reading and writing goes through its methods.
pub(crate) struct StudyTransaction<'a> {
    db: &'a Connection,
    study: &'a Study,
    /// Unix time of the request, milliseconds.
    now_ms: i64,
}

impl StudyTransaction<'_> {
    /// The study to which the database belongs.
    pub(crate) fn study(&self) -> &Study {
        self.study
    }

    /// A value of the table `meta`, which holds facts about the whole study by key.
    fn read_meta(&self, key: &str) -> Result<Option<String>, StudyError> {
        use rusqlite::OptionalExtension as _;
        Ok(self.db.query_row("SELECT value FROM meta WHERE key = ?1", [key], |row| row.get(0)).optional()?)
    }

    fn set_meta(&self, key: &str, value: &str) -> Result<(), StudyError> {
        self.db.execute(
            "INSERT INTO meta (key, value) VALUES (?1, ?2) ON CONFLICT (key) DO UPDATE SET value = excluded.value",
            [key, value],
        )?;
        Ok(())
    }

    /// The folders to which results were written.
    pub(crate) fn list_exports(&self) -> Result<Vec<PathBuf>, StudyError> {
        Ok(self.read_meta("exports")?.and_then(|folders| serde_json::from_str(&folders).ok()).unwrap_or_default())
    }

    /// Remembers a folder to which results were written.
    pub(crate) fn note_export(&self, folder: &Path) -> Result<(), StudyError> {
        let mut folders = self.list_exports()?;
        if !folders.iter().any(|known| known == folder) {
            folders.push(folder.to_owned());
        }
        let folders: Vec<_> = folders.iter().map(|folder| folder.to_string_lossy()).collect();
        self.set_meta("exports", &serde_json::json!(folders).to_string())
    }

    /// Whether the study is closed and accepts no more answers.
    pub(crate) fn is_closed(&self) -> Result<bool, StudyError> {
        Ok(self.read_meta("closed_ms")?.is_some())
    }
}

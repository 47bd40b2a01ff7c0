//! What people gave: one SQLite file. Everything that is said to be kept is on disk.

mod answers;
mod assign;
mod counts;
mod desk;
mod people;
mod read;
mod recruits;
mod stage;

pub(crate) use answers::{Given, Refusal};
pub use counts::{Progress, Row};
pub(crate) use desk::{Busy, Desk, now_ms};
pub(crate) use people::{Arrival, Entry, Outcome, Withdrawal};
pub use people::{Forgotten, Invited};
pub use recruits::{Reconciled, Reconciliation};
pub(crate) use stage::{Held, Stage};

use crate::study::{Study, StudyError};
use rusqlite::{Connection, TransactionBehavior};
use std::{path::Path, time::Duration};

const SCHEMA: &str = include_str!("schema.sql");
/// Version of the schema.
const VERSION: i64 = 1;
/// How long a command waits for another process that is writing.
const BUSY: Duration = Duration::from_secs(10);

/// The database of a study.
#[derive(Debug)]
pub(crate) struct Store {
    db: Connection,
}

impl Store {
    /// Opens the database, and makes it where there is none.
    ///
    /// # Errors
    /// When it cannot be opened, or is of a later version.
    pub(crate) fn open(file: &Path) -> Result<Self, StudyError> {
        let db = Connection::open(file)?;
        db.busy_timeout(BUSY)?;
        db.pragma_update(None, "journal_mode", "WAL")?;
        // An answer that was acknowledged survives a loss of power.
        db.pragma_update(None, "synchronous", "FULL")?;
        db.pragma_update(None, "foreign_keys", true)?;
        // What is forgotten is overwritten, not only unlinked.
        db.pragma_update(None, "secure_delete", true)?;
        let version: i64 = db.pragma_query_value(None, "user_version", |row| row.get(0))?;
        if version > VERSION {
            let problem = format!("{}: it was made by a later version of this program", file.display());
            return Err(StudyError::refused(problem, "use that version"));
        }
        db.execute_batch(SCHEMA)?;
        db.pragma_update(None, "user_version", VERSION)?;
        Ok(Self { db })
    }

    /// Does something as one transaction: all of it is kept, or nothing.
    ///
    /// # Errors
    /// What `work` returns, or what SQLite says.
    pub(crate) fn write<T>(
        &mut self,
        study: &Study,
        now_ms: i64,
        work: impl FnOnce(&Book<'_>) -> Result<T, StudyError>,
    ) -> Result<T, StudyError> {
        let transaction = self.db.transaction_with_behavior(TransactionBehavior::Immediate)?;
        let done = work(&Book { db: &transaction, study, now_ms })?;
        transaction.commit()?;
        Ok(done)
    }
}

/// The database inside a transaction, at a time: all that can be read and written stands on it.
pub(crate) struct Book<'a> {
    db: &'a Connection,
    study: &'a Study,
    now_ms: i64,
}

impl Book<'_> {
    fn meta(&self, key: &str) -> Result<Option<String>, StudyError> {
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

    /// Whether the study takes no more answers.
    pub(crate) fn is_closed(&self) -> Result<bool, StudyError> {
        Ok(self.meta("closed_ms")?.is_some())
    }
}

//! Errors of the ledger.

use crate::LedgerLocation;
use rusqlite::ErrorCode;
use std::{io::ErrorKind, path::PathBuf, sync::Arc};

/// The ledger, or a recording, cannot be used.
#[derive(Debug, Clone, thiserror::Error)]
pub enum LedgerError {
    /// The file is not a ledger. It was left as it is.
    #[error("{}: this file is not a ledger\nhint: give a ledger with --ledger FILE, or leave the flag out for the default", .0.display())]
    NoLedger(PathBuf),
    /// The name is that of a folder, a pipe, a device or a socket. Opening a pipe would wait for ever.
    #[error("{}: this is a folder, a pipe or a device, not a file\nhint: give a ledger with --ledger FILE, or leave the flag out for the default", .0.display())]
    NotAFile(PathBuf),
    /// A newer version of the program made the file. It was left as it is.
    #[error("{}: a newer version of this program made this ledger (format {format})\nhint: use that version, or give another ledger with --ledger FILE", path.display())]
    Newer {
        /// The file.
        path: PathBuf,
        /// Its format.
        format: i64,
    },
    /// The file is, or would be, on a file system on which the database is not reliable.
    #[error("{}: a ledger cannot be kept on {kind}, a network file system: locks may fail there, and answers that you paid for could be lost\nhint: give a file on a disk of this machine, as in --ledger /tmp/ledger.db; if you already have a ledger there, copy it while no program uses it", path.display())]
    Network {
        /// The file.
        path: PathBuf,
        /// The name of the file system, as NFS.
        kind: &'static str,
    },
    /// An answer is not the one that was written.
    #[error("{place}: the answer of {model} to call {key} was changed after it was written, by a damaged disk or by hand\nhint: {} drops all changed answers; then the same command makes those calls again", place.prune_changed())]
    Changed {
        /// The file or the database.
        place: LedgerLocation,
        /// The call.
        key: String,
        /// The model that gave the answer.
        model: String,
    },
    /// The database returned an error.
    #[error("{place}: cannot {doing} the ledger: {reason}\nhint: {hint}")]
    Store {
        /// The file or the database.
        place: LedgerLocation,
        /// The operation that failed, as a verb after "cannot".
        doing: &'static str,
        /// The database's message.
        reason: String,
        /// How the user can fix it.
        hint: &'static str,
        /// Whether the disk is full, or fails.
        is_lost: bool,
    },
    /// A file operation failed.
    #[error(
        "{place}: cannot {doing}: {source}\nhint: check that the file or its folder exists, that you may use it, and that the disk has room"
    )]
    Io {
        /// The file that failed, or the ledger that was being exported to a file.
        place: LedgerLocation,
        /// The operation that failed, as a verb after "cannot".
        doing: &'static str,
        /// The system's error.
        source: Arc<std::io::Error>,
    },
    /// The database on a server cannot be used.
    #[error("{reason}")]
    Database {
        /// The database, the operation that failed, and what to do.
        reason: String,
        /// Whether the server or the way to it failed.
        is_lost: bool,
    },
    /// The database answers too slowly to keep a rate for all programs.
    #[error(
        "{place}: the database answers too slowly to keep one rate for all workers\nhint: use a database near the workers, or leave the provider's requests_per_minute and tokens_per_minute out"
    )]
    Slow {
        /// The database.
        place: LedgerLocation,
    },
    /// A line of a chunk's file cannot be read.
    #[error("{}: line {line}: {reason}\nhint: put a copy of the file in its place, or move it away: then its calls are made again", path.display())]
    Chunk {
        /// The file.
        path: PathBuf,
        /// Its line, from 1.
        line: usize,
        /// The problem of the line.
        reason: String,
    },
    /// The program uses the ledger in a way in which it cannot be used.
    #[error("{place}: {reason}\nhint: this is a fault of the program: please report it")]
    Misuse {
        /// The file or the database.
        place: LedgerLocation,
        /// The wrong use.
        reason: &'static str,
    },
    /// A line of a recording cannot be read.
    #[error("{}: line {line}: {reason}\nhint: give a file that --record or `wayword ledger export` wrote; if it is one, use the version that wrote it, or record again", path.display())]
    Recording {
        /// The file.
        path: PathBuf,
        /// Its line, from 1.
        line: usize,
        /// The problem of the line.
        reason: String,
    },
}

impl LedgerError {
    /// Makes errors of SQLite into errors of the ledger at `path`, for an operation `doing`.
    pub(crate) fn store_error(path: &std::path::Path, doing: &'static str) -> impl Fn(rusqlite::Error) -> Self {
        let place = LedgerLocation::from_path(path);
        move |error| Self::Store {
            place: place.clone(),
            doing,
            reason: error.to_string(),
            hint: sqlite_hint(&error),
            is_lost: matches!(error.sqlite_error_code(), Some(ErrorCode::DiskFull | ErrorCode::SystemIoFailure)),
        }
    }

    /// Whether the disk is full or fails, or the server is away. The answers so far are kept.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        match self {
            Self::Store { is_lost, .. } | Self::Database { is_lost, .. } => *is_lost,
            Self::Io { source, .. } => matches!(source.kind(), ErrorKind::StorageFull | ErrorKind::QuotaExceeded),
            _ => false,
        }
    }

    /// Makes errors of the system into errors of the ledger at `place`, for an operation `doing`.
    pub(crate) fn io_error(place: impl Into<LedgerLocation>, doing: &'static str) -> impl Fn(std::io::Error) -> Self {
        let place = place.into();
        move |source| Self::Io { place: place.clone(), doing, source: Arc::new(source) }
    }
}

#[cfg(feature = "postgres")]
impl From<wayword_database::DatabaseError> for LedgerError {
    fn from(error: wayword_database::DatabaseError) -> Self {
        Self::Database { reason: error.to_string(), is_lost: error.is_lost() }
    }
}

/// How the user can fix an error of SQLite.
fn sqlite_hint(error: &rusqlite::Error) -> &'static str {
    match error.sqlite_error_code() {
        Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => {
            "another program has it locked: wait for that program, or give another --ledger"
        }
        Some(ErrorCode::DiskFull) => "the disk is full: make room; all answers so far are kept",
        Some(ErrorCode::SystemIoFailure) => "the disk fails: check it; all answers so far are kept",
        Some(ErrorCode::ReadOnly | ErrorCode::PermissionDenied | ErrorCode::CannotOpen) => {
            "it cannot be written there: check the folder's permissions, or give another --ledger"
        }
        Some(ErrorCode::DatabaseCorrupt | ErrorCode::NotADatabase) => {
            "the file is damaged: move it away, or give another --ledger"
        }
        _ => "check the file and its folder, or give another --ledger",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rusqlite::ffi;
    use std::path::Path;

    #[test]
    fn a_full_disk_is_a_loss_and_a_locked_database_is_not() {
        let error = |code| rusqlite::Error::SqliteFailure(ffi::Error::new(code), None);
        let store = |code| LedgerError::store_error(Path::new("ledger.db"), "write")(error(code));
        assert!(store(ffi::SQLITE_FULL).is_lost() && store(ffi::SQLITE_IOERR_WRITE).is_lost());
        assert!(!store(ffi::SQLITE_BUSY).is_lost());
    }
}

//! What can go wrong with a ledger.

use std::{path::PathBuf, sync::Arc};

/// The ledger cannot do what it is for.
#[derive(Debug, Clone, thiserror::Error)]
pub enum LedgerError {
    /// The file is something else, and was left as it is.
    #[error("{}: this file is no ledger\nhint: name another file", .0.display())]
    NoLedger(PathBuf),
    /// A newer program made it; it was left as it is.
    #[error("{}: a newer version of this program made this ledger (format {format})\nhint: use that version, or name another file", path.display())]
    Newer {
        /// The file.
        path: PathBuf,
        /// Its format.
        format: i64,
    },
    /// The file lies, or would lie, where the database cannot be relied on.
    #[error("{}: a ledger cannot be kept on {kind}, a network's file system: its locks may not hold, and what was paid for could be lost\nhint: name a file on a disk of this machine, as in --ledger /tmp/ledger.db; copy one that you have there while nothing uses it", path.display())]
    Network {
        /// The file.
        path: PathBuf,
        /// What the file system is called.
        kind: &'static str,
    },
    /// An answer is not the one that was written.
    #[error("{}: the answer of {model} to call {key} was changed after it was written, by a damaged disk or by hand\nhint: `wayword ledger prune --changed --ledger {}` drops all such answers; the same command then asks them anew", path.display(), path.display())]
    Changed {
        /// The file.
        path: PathBuf,
        /// The call.
        key: String,
        /// Whose answer it was.
        model: String,
    },
    /// The database would not.
    #[error("{}: cannot {doing} the ledger: {reason}\nhint: {hint}", path.display())]
    Store {
        /// The file.
        path: PathBuf,
        /// What was tried.
        doing: &'static str,
        /// What the database said.
        reason: String,
        /// What to do.
        hint: &'static str,
    },
    /// A file would not.
    #[error("{}: cannot {doing}: {source}\nhint: see whether the file or its folder is there, may be used, and has room", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was tried.
        doing: &'static str,
        /// What the system said.
        source: Arc<std::io::Error>,
    },
    /// A line of a recording that is none.
    #[error("{}: line {line}: {reason}\nhint: make the recording again with --record", path.display())]
    Recording {
        /// The file.
        path: PathBuf,
        /// Its line, from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
}

impl LedgerError {
    pub(crate) fn store(path: &std::path::Path, doing: &'static str) -> impl Fn(rusqlite::Error) -> Self {
        let path = path.to_owned();
        move |error| Self::Store { path: path.clone(), doing, reason: error.to_string(), hint: hint(&error) }
    }

    pub(crate) fn io(path: &std::path::Path, doing: &'static str) -> impl Fn(std::io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { path: path.clone(), doing, source: Arc::new(source) }
    }
}

fn hint(error: &rusqlite::Error) -> &'static str {
    use rusqlite::ErrorCode;
    match error.sqlite_error_code() {
        Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => {
            "another program holds it: wait for that one, or give another --ledger"
        }
        Some(ErrorCode::DiskFull) => "the disk is full: make room; what was answered is kept",
        Some(ErrorCode::ReadOnly | ErrorCode::PermissionDenied | ErrorCode::CannotOpen) => {
            "it cannot be written there: see the folder's permissions, or give another --ledger"
        }
        Some(ErrorCode::DatabaseCorrupt | ErrorCode::NotADatabase) => {
            "the file is damaged: move it away, or give another --ledger"
        }
        _ => "see the file and its folder, or give another --ledger",
    }
}

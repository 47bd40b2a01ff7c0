//! Errors of making, serving and reading a study.

use std::{io, path::PathBuf};

/// An error with a problem and, where there is one, a hint at what to do.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// A file operation failed.
    #[error("{}: cannot {doing}: {source}", path.display())]
    Io {
        /// Which file or folder.
        path: PathBuf,
        /// What was tried.
        doing: &'static str,
        /// The error of the system.
        source: io::Error,
    },
    /// A file of the study cannot be used.
    #[error("{}: {problem}\nhint: {hint}", path.display())]
    File {
        /// Which file.
        path: PathBuf,
        /// The problem, and its place in the file.
        problem: String,
        /// What to do.
        hint: &'static str,
    },
    /// The user asked for something that cannot be done.
    #[error("{problem}\nhint: {hint}")]
    Refused {
        /// The problem.
        problem: String,
        /// What to do.
        hint: String,
    },
    /// The database cannot be used.
    #[error("study.db: {source}\nhint: {}", hint_of(source))]
    Store {
        /// Its error.
        #[from]
        source: rusqlite::Error,
    },
}

impl StudyError {
    /// An adapter for `map_err`. `doing` is a verb that completes "cannot ...".
    pub(crate) fn io_error(path: impl Into<PathBuf>, doing: &'static str) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, doing, source }
    }

    /// Whether the database's disk is full or fails.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        use rusqlite::ErrorCode::{DiskFull, SystemIoFailure};
        matches!(self, Self::Store { source } if matches!(source.sqlite_error_code(), Some(DiskFull | SystemIoFailure)))
    }

    /// Whether the disk is full, fails or cannot be written.
    pub(crate) fn is_of_disk(&self) -> bool {
        let is_read_only = |source: &rusqlite::Error| source.sqlite_error_code() == Some(rusqlite::ErrorCode::ReadOnly);
        self.is_lost() || matches!(self, Self::Store { source } if is_read_only(source))
    }

    pub(crate) fn refused_request(problem: impl Into<String>, hint: impl Into<String>) -> Self {
        Self::Refused { problem: problem.into(), hint: hint.into() }
    }
}

/// Advice for an error of the database.
fn hint_of(error: &rusqlite::Error) -> &'static str {
    use rusqlite::ErrorCode;
    match error.sqlite_error_code() {
        Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => "another process is writing to it; try again",
        Some(ErrorCode::DiskFull) => "free some space, and try again; what was acknowledged is kept",
        Some(ErrorCode::ReadOnly | ErrorCode::CannotOpen | ErrorCode::PermissionDenied) => {
            "check that the folder exists and can be written"
        }
        Some(ErrorCode::DatabaseCorrupt | ErrorCode::NotADatabase) => "it is damaged: put back a copy of the folder",
        _ => "check the folder and its disk",
    }
}

//! The location of a ledger, as messages name it.

use std::{
    fmt,
    path::{Path, PathBuf},
};

/// The location of a ledger. Its text names a file or a database, and never contains a password.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LedgerLocation {
    /// A file.
    File(PathBuf),
    /// A database on a server.
    Database(String),
}

impl LedgerLocation {
    pub(crate) fn from_path(path: &Path) -> Self {
        Self::File(path.to_owned())
    }

    /// The command with which a user drops the changed answers of this ledger, for messages. It is not run here.
    pub(crate) fn prune_changed(&self) -> String {
        match self {
            Self::File(path) => format!("`wayword ledger prune --changed --ledger {}`", path.display()),
            Self::Database(_) => "`wayword ledger prune --changed` with this database".to_owned(),
        }
    }
}

impl From<&Path> for LedgerLocation {
    fn from(path: &Path) -> Self {
        Self::from_path(path)
    }
}

impl From<&PathBuf> for LedgerLocation {
    fn from(path: &PathBuf) -> Self {
        Self::from_path(path)
    }
}

impl fmt::Display for LedgerLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => path.display().fmt(f),
            Self::Database(name) => f.write_str(name),
        }
    }
}

//! Keeps a second server away from a study that is being served.

use super::StudyError;
use std::{
    fs::{File, TryLockError},
    path::Path,
};

/// The file that a server locks. It stays when the server ends; the system drops the lock, also after a kill.
const LOCK_FILE: &str = "serve.lock";

/// The lock of the one server of a study, until it is dropped.
#[derive(Debug)]
pub(crate) struct ServeLock {
    _file: File,
}

impl ServeLock {
    /// Locks a study's folder.
    ///
    /// # Errors
    /// When another server has it, or the file cannot be opened.
    pub(crate) fn acquire(folder: &Path) -> Result<Self, StudyError> {
        let path = folder.join(LOCK_FILE);
        let file = File::options()
            .create(true)
            .truncate(false)
            .write(true)
            .open(&path)
            .map_err(StudyError::io_error(&path, "open"))?;
        match file.try_lock() {
            Ok(()) => Ok(Self { _file: file }),
            Err(TryLockError::WouldBlock) => Err(StudyError::refused_request(
                format!("{}: another `wayword study serve` serves this study already", folder.display()),
                "use its address, or stop it first; `study invite` makes links while it runs",
            )),
            // Some network file systems have no locks. SQLite locks its own file in another way.
            Err(TryLockError::Error(_)) => Ok(Self { _file: file }),
        }
    }
}

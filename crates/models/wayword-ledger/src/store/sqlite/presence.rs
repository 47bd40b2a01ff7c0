//! Finds out whether a program that uses the ledger is still running.
//!
//! Each program holds a lock on its own file next to the ledger. The system releases the lock when the program ends,
//! however it ends. So reused process numbers cause no confusion, and the lock works between containers. Locks work on
//! one machine: a ledger on a network file system is refused earlier.

use crate::LedgerError;
use std::{
    fs::{self, File, OpenOptions, TryLockError},
    path::{Path, PathBuf},
    sync::atomic::{AtomicU64, Ordering},
    time::{SystemTime, UNIX_EPOCH},
};

/// The part of the file's name between the ledger's name and the program's.
const PRESENCE_FILE_MARK: &str = ".in-use-";

/// A file that this program keeps locked as long as it uses the ledger.
#[derive(Debug)]
pub(super) struct PresenceFile {
    /// The unique name of this program: its process number, the time and a counter, in hexadecimal digits.
    name: String,
    path: PathBuf,
    /// Open as long as the lock is held.
    _locked: File,
}

impl PresenceFile {
    /// Makes and locks this program's file.
    pub(super) fn new(ledger: &Path) -> Result<Self, LedgerError> {
        static NUMBER: AtomicU64 = AtomicU64::new(0);
        loop {
            let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_micros();
            let number = NUMBER.fetch_add(1, Ordering::Relaxed);
            let name = format!("{:x}-{since:x}-{number:x}", std::process::id());
            let path = presence_path(ledger, &name);
            let failed = LedgerError::io_error(&path, "say that the ledger is in use");
            let mut options = OpenOptions::new();
            options.create_new(true).write(true);
            #[cfg(unix)]
            std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
            let file = options.open(&path).map_err(&failed)?;
            file.lock().map_err(&failed)?;
            // Before the lock, another program may have removed the file, because it seemed left behind.
            if path.exists() {
                return Ok(Self { name, path: path.clone(), _locked: file });
            }
        }
    }

    /// The unique name of this program, which is part of its file's name.
    pub(super) fn name(&self) -> &str {
        &self.name
    }
}

impl Drop for PresenceFile {
    fn drop(&mut self) {
        // If this fails, the next program removes the file.
        let _ = fs::remove_file(&self.path);
    }
}

/// Whether the program of that name has ended. If this cannot be found out, it counts as running.
pub(super) fn is_gone(ledger: &Path, name: &str) -> bool {
    // A damaged ledger may contain any name.
    if name.is_empty() || !name.chars().all(|c| c.is_ascii_hexdigit() || c == '-') {
        return true;
    }
    match File::open(presence_path(ledger, name)) {
        Ok(file) => file.try_lock_shared().is_ok(),
        Err(error) => error.kind() == std::io::ErrorKind::NotFound,
    }
}

/// Removes the files of programs that have ended, and returns the programs' names.
pub(super) fn remove_stale_files(ledger: &Path) -> Vec<String> {
    let (Some(folder), Some(file)) = (ledger.parent(), ledger.file_name()) else { return Vec::new() };
    let prefix = format!("{}{PRESENCE_FILE_MARK}", file.to_string_lossy());
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| Some(entry.file_name().to_str()?.strip_prefix(&prefix)?.to_owned()));
    names.filter(|name| remove_if_stale(&presence_path(ledger, name))).collect()
}

/// Removes a file if no program has it locked. Returns whether it did.
fn remove_if_stale(path: &Path) -> bool {
    let Ok(file) = File::open(path) else { return false };
    match file.try_lock() {
        Ok(()) => fs::remove_file(path).is_ok(),
        Err(TryLockError::WouldBlock | TryLockError::Error(_)) => false,
    }
}

/// The path of a program's file next to the ledger, as `ledger.db.in-use-1f-2e-0`.
fn presence_path(ledger: &Path, name: &str) -> PathBuf {
    let mut path = ledger.as_os_str().to_owned();
    path.push(format!("{PRESENCE_FILE_MARK}{name}"));
    path.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_is_there_until_it_lets_go() {
        let folder = tempfile::tempdir().unwrap();
        let ledger = folder.path().join("l.db");
        let here = PresenceFile::new(&ledger).unwrap();
        let name = here.name().to_owned();
        assert!(!is_gone(&ledger, &name));
        assert_eq!(remove_stale_files(&ledger), Vec::<String>::new());
        drop(here);
        assert!(is_gone(&ledger, &name));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn remove_stale_files_removes_the_file_of_a_killed_program() {
        let folder = tempfile::tempdir().unwrap();
        let ledger = folder.path().join("l.db");
        let here = PresenceFile::new(&ledger).unwrap();
        fs::write(presence_path(&ledger, "1f-2e-0"), "").unwrap();
        fs::write(folder.path().join("other.db.in-use-1f-2e-0"), "").unwrap();
        assert!(is_gone(&ledger, "1f-2e-0"));
        assert_eq!(remove_stale_files(&ledger), ["1f-2e-0"]);
        assert!(!is_gone(&ledger, here.name()));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn is_gone_accepts_no_malformed_name() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("x"), "").unwrap();
        for name in ["", "../x", "a/../../x", "\u{e9}"] {
            assert!(is_gone(&folder.path().join("l.db"), name), "{name:?}");
        }
    }
}

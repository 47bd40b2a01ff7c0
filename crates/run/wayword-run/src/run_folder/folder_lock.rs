//! Makes sure that only one process works in a folder.
//!
//! On this machine's own disks a lock does that. On a network file system a lock may apply to one machine only, or not at all.
//! There the process also makes the file `run.owner`, which only one process can create and which names that process, and
//! removes it at the end. If a killed process of this machine left the file behind, the program finds that this process is gone
//! and removes the file. It cannot find that out about another machine: then the user, who knows that the process is gone, has
//! to remove it. The program recognises network file systems on Linux only.

use super::file;
use crate::{error::CommandError, interrupt};
use std::{
    fs::{self, File, TryLockError},
    io::{ErrorKind, Write},
    path::{Path, PathBuf},
};
use wayword_queue::ProcessIdentity;

/// A folder that no other process works in for as long as this lives.
#[derive(Debug)]
pub struct FolderLock {
    /// `None` if a network file system has no locks.
    _lock: Option<File>,
    /// The file `run.owner`; `None` on a disk of this machine.
    _mark: Option<OwnerMark>,
}

/// The file that names the process at work in a folder on a network file system; removed on drop.
#[derive(Debug)]
struct OwnerMark(PathBuf);

/// Locks a folder against other processes, until the returned value is dropped.
///
/// # Errors
/// When another process works in the folder, or may do so.
pub fn lock_folder(folder: &Path) -> Result<FolderLock, CommandError> {
    lock_on_file_system(folder, wayword_ledger::network_at(folder))
}

/// Locks a folder. `network` is the kind of its network file system; `None` on a disk of this machine.
fn lock_on_file_system(folder: &Path, network: Option<&'static str>) -> Result<FolderLock, CommandError> {
    let path = folder.join(file::LOCK);
    let lock = File::options()
        .create(true)
        .truncate(false)
        .write(true)
        .open(&path)
        .map_err(CommandError::io(&path, "open"))?;
    let lock = match lock.try_lock() {
        Ok(()) => Some(lock),
        Err(TryLockError::WouldBlock) => return Err(CommandError::Busy(folder.to_owned())),
        // On a network file system only the owner's file is reliable.
        Err(TryLockError::Error(_)) if network.is_some() => None,
        Err(TryLockError::Error(source)) => return Err(CommandError::Io { path, doing: "lock", source }),
    };
    let mark = network.map(|kind| OwnerMark::new(folder, kind, &ProcessIdentity::this_process())).transpose()?;
    Ok(FolderLock { _lock: lock, _mark: mark })
}

impl OwnerMark {
    fn new(folder: &Path, kind: &'static str, owner: &ProcessIdentity) -> Result<Self, CommandError> {
        let path = folder.join(file::OWNER);
        let text = serde_json::to_string(owner).map_err(|error| CommandError::Io {
            path: path.clone(),
            doing: "write",
            source: error.into(),
        })?;
        // A second attempt, if the first removes the file of a dead process.
        for _ in 0..2 {
            match File::options().create_new(true).write(true).open(&path) {
                Ok(mut file) => {
                    interrupt::remove_on_exit(&path);
                    file.write_all(text.as_bytes()).map_err(CommandError::io(&path, "write"))?;
                    return Ok(Self(path));
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => clear_dead_owner(folder, &path, kind, owner)?,
                Err(source) => return Err(CommandError::Io { path, doing: "make", source }),
            }
        }
        Err(CommandError::Busy(folder.to_owned()))
    }
}

/// Removes the file `run.owner` of a process that is gone. Refuses if that process is alive or on another machine.
fn clear_dead_owner(
    folder: &Path,
    path: &Path,
    kind: &'static str,
    this_process: &ProcessIdentity,
) -> Result<(), CommandError> {
    let text = crate::text_file::read_text_file(path, "read who works in the folder")?;
    let by: Option<ProcessIdentity> = serde_json::from_str(&text).ok();
    match by {
        Some(by) if !by.is_beside(this_process) => {
            let by = format!("process {} of {}", by.pid, by.host);
            Err(CommandError::BusyElsewhere { folder: folder.to_owned(), by, kind, mark: path.to_owned() })
        }
        Some(by) if by.lives_here() => Err(CommandError::Busy(folder.to_owned())),
        Some(_) => fs::remove_file(path).map_err(CommandError::io(path, "remove")),
        // Killed before it was written, or still being written.
        None => {
            let by = "another process".to_owned();
            Err(CommandError::BusyElsewhere { folder: folder.to_owned(), by, kind, mark: path.to_owned() })
        }
    }
}

impl Drop for OwnerMark {
    fn drop(&mut self) {
        // If the file stays, the next process reports it.
        let _ = fs::remove_file(&self.0);
    }
}

#[cfg(test)]
#[cfg(target_os = "linux")]
mod tests {
    use super::*;

    fn left_behind(folder: &Path, owner: &ProcessIdentity) -> std::io::Result<PathBuf> {
        let path = folder.join(file::OWNER);
        fs::write(&path, serde_json::to_string(owner)?)?;
        Ok(path)
    }

    #[test]
    fn lock_folder_names_its_process_in_a_file_on_a_network() {
        let folder = tempfile::tempdir().unwrap();
        let held = lock_on_file_system(folder.path(), Some("NFS")).unwrap();
        assert!(folder.path().join(file::OWNER).exists());
        assert!(matches!(lock_on_file_system(folder.path(), Some("NFS")), Err(CommandError::Busy(_))));
        drop(held);
        assert!(!folder.path().join(file::OWNER).exists());
        drop(lock_on_file_system(folder.path(), None).unwrap());
        assert!(!folder.path().join(file::OWNER).exists(), "a disk of this machine needs none");
    }

    #[test]
    fn a_process_of_another_machine_is_never_taken_for_gone() {
        let folder = tempfile::tempdir().unwrap();
        let far = ProcessIdentity { host: "node17".into(), place: "another".into(), ..ProcessIdentity::this_process() };
        let path = left_behind(folder.path(), &far).unwrap();
        let error = lock_on_file_system(folder.path(), Some("Lustre")).unwrap_err();
        let told = error.to_string();
        assert!(["node17", "Lustre", "run.owner", "remove"].iter().all(|part| told.contains(part)), "{told}");
        assert_eq!(error.exit_code(), crate::error::Exit::Busy);
        fs::remove_file(path).unwrap();
        assert!(lock_on_file_system(folder.path(), Some("Lustre")).is_ok());
    }

    #[test]
    fn a_process_of_this_machine_that_is_gone_gives_way() {
        let folder = tempfile::tempdir().unwrap();
        let gone = ProcessIdentity { began: "1".into(), ..ProcessIdentity::this_process() };
        left_behind(folder.path(), &gone).unwrap();
        assert!(lock_on_file_system(folder.path(), Some("NFS")).is_ok(), "its number is another process's now");
        left_behind(folder.path(), &ProcessIdentity::beside_this(std::os::unix::process::parent_id())).unwrap();
        assert!(matches!(lock_on_file_system(folder.path(), Some("NFS")), Err(CommandError::Busy(_))));
    }

    #[test]
    fn lock_folder_refuses_a_half_written_owner_file() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(file::OWNER), "{\"host\": \"no").unwrap();
        assert!(matches!(lock_on_file_system(folder.path(), Some("NFS")), Err(CommandError::BusyElsewhere { .. })));
    }
}

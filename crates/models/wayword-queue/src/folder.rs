//! Writes files so that readers find them whole or not at all, on local disks and on network file systems.
//!
//! A file is first written and synced under another name, and then gets its own name in one step.

use crate::QueueError;
use std::{
    fs::{self, File},
    io::{self, ErrorKind, Write},
    path::{Path, PathBuf},
    sync::atomic::{AtomicU64, Ordering},
    time::{SystemTime, UNIX_EPOCH},
};

/// The path of a file until it is whole: in the same folder, under a name that no other process uses, on any machine.
fn unfinished_path(path: &Path) -> PathBuf {
    static NEXT_NUMBER: AtomicU64 = AtomicU64::new(0);
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos();
    let number = NEXT_NUMBER.fetch_add(1, Ordering::Relaxed);
    let mut name = path.as_os_str().to_owned();
    name.push(format!(".new-{:x}-{since:x}-{number:x}", std::process::id()));
    name.into()
}

/// Writes a new file and waits until it is on the disk.
fn write_synced(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::options().create_new(true).write(true).open(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// Writes a file if there is none of that name, and returns whether it did. The finished file gets its name by a hard
/// link: of several writers one wins, on network file systems too.
///
/// # Errors
/// When it cannot be written.
pub fn put_new(path: &Path, bytes: &[u8]) -> Result<bool, QueueError> {
    let unfinished = unfinished_path(path);
    let done = write_synced(&unfinished, bytes).and_then(|()| match fs::hard_link(&unfinished, path) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == ErrorKind::AlreadyExists => Ok(false),
        // A file server's answer can be lost after it made the link. Two links show that it did.
        Err(error) => {
            if has_two_links(&unfinished) {
                Ok(true)
            } else {
                Err(error)
            }
        }
    });
    // If this fails, the extra name does no harm.
    let _ = fs::remove_file(&unfinished);
    let is_new = done.map_err(QueueError::for_file(path, "write"))?;
    if is_new {
        sync_folder_of(path).map_err(QueueError::for_file(path, "sync the folder of"))?;
    }
    Ok(is_new)
}

/// Whether a file has exactly two names. Not known on systems other than Unix.
#[cfg(unix)]
fn has_two_links(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|about| std::os::unix::fs::MetadataExt::nlink(&about) == 2)
}

#[cfg(not(unix))]
fn has_two_links(_: &Path) -> bool {
    false
}

/// Writes a file, in place of an older file of that name.
///
/// # Errors
/// When it cannot be written.
pub fn put_whole(path: &Path, bytes: &[u8]) -> Result<(), QueueError> {
    let unfinished = unfinished_path(path);
    let done = write_synced(&unfinished, bytes).and_then(|()| fs::rename(&unfinished, path));
    if done.is_err() {
        let _ = fs::remove_file(&unfinished);
    }
    done.map_err(QueueError::for_file(path, "write"))
}

/// Removes a file, if it is there.
pub(crate) fn remove_if_there(path: &Path) -> Result<(), QueueError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(QueueError::for_file(path, "remove")(error)),
        _ => Ok(()),
    }
}

fn sync_folder_of(path: &Path) -> io::Result<()> {
    match path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        Some(folder) => sync_folder(folder),
        None => sync_folder(Path::new(".")),
    }
}

/// Makes sure that the names in a folder survive a crash. Some systems cannot sync a folder; there the names are as safe as
/// the system makes them.
fn sync_folder(folder: &Path) -> io::Result<()> {
    match File::open(folder)?.sync_all() {
        Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => Ok(()),
        done => done,
    }
}

/// Makes sure that every file of a folder, and of the folders in it, survives a crash of the machine.
///
/// # Errors
/// When a file cannot be synced.
pub fn sync_tree(folder: &Path) -> Result<(), QueueError> {
    for entry in fs::read_dir(folder).map_err(QueueError::for_file(folder, "list"))? {
        let entry = entry.map_err(QueueError::for_file(folder, "list"))?;
        let path = entry.path();
        let kind = entry.file_type().map_err(QueueError::for_file(&path, "look at"))?;
        if kind.is_dir() {
            sync_tree(&path)?;
        } else if kind.is_file() {
            File::open(&path).and_then(|file| file.sync_all()).map_err(QueueError::for_file(&path, "sync"))?;
        }
    }
    sync_folder(folder).map_err(QueueError::for_file(folder, "sync"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread;

    #[test]
    fn put_new_lets_one_of_many_writers_win() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mark");
        let wins: Vec<bool> = thread::scope(|scope| {
            let writers: Vec<_> = (0..16u8)
                .map(|number| {
                    let path = &path;
                    scope.spawn(move || put_new(path, &[number]).unwrap())
                })
                .collect();
            writers.into_iter().map(|writer| writer.join().unwrap()).collect()
        });
        let winner = wins.iter().position(|won| *won).unwrap();
        assert_eq!(wins.iter().filter(|won| **won).count(), 1);
        assert_eq!(fs::read(&path).unwrap(), [u8::try_from(winner).unwrap()]);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing else is left behind");
    }
}

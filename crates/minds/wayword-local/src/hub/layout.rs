//! The cache's folders, as the hub's own client has them.

use super::{commit::Commit, hash::BlobHash, name::OnHub};
use crate::LocalError;
use std::{
    fs::{self, File, OpenOptions, TryLockError},
    io::{self, Read},
    path::{Path, PathBuf},
    sync::atomic::{AtomicU64, Ordering},
};

/// One model's part of the cache.
#[derive(Debug)]
pub(super) struct RepoFolder {
    root: PathBuf,
    locks: PathBuf,
}

impl RepoFolder {
    pub(super) fn new(cache: &Path, place: &OnHub) -> Self {
        let name = format!("models--{}--{}", place.org, place.name);
        Self { root: cache.join(&name), locks: cache.join(".locks").join(name) }
    }

    /// The folder of a commit's files.
    pub(super) fn snapshot(&self, commit: &str) -> PathBuf {
        self.root.join("snapshots").join(commit)
    }

    /// Where bytes lie that have this hash.
    pub(super) fn blob(&self, hash: &BlobHash) -> PathBuf {
        self.root.join("blobs").join(hash.as_str())
    }

    /// What a revision stood for when it was fetched.
    pub(super) fn commit_of(&self, revision: &str) -> Option<Commit> {
        if let Some(commit) = Commit::parse(revision) {
            return Some(commit);
        }
        let mut text = String::new();
        File::open(self.root.join("refs").join(revision)).ok()?.take(100).read_to_string(&mut text).ok()?;
        Commit::parse(text.trim())
    }

    /// Keeps what a revision stands for.
    pub(super) fn keep_ref(&self, revision: &str, commit: &Commit) -> Result<(), LocalError> {
        if self.commit_of(revision).as_ref() == Some(commit) {
            return Ok(());
        }
        let path = self.root.join("refs").join(revision);
        make_parent(&path)?;
        // Written whole or not at all: somebody may read it right now.
        let fresh = fresh_beside(&path);
        fs::write(&fresh, commit.as_str()).map_err(|error| LocalError::io(&fresh, "write", error))?;
        fs::rename(&fresh, &path).map_err(|error| LocalError::io(&path, "write", error))
    }

    /// Whether a commit is known to lack a file.
    pub(super) fn is_absent(&self, commit: &Commit, file: &str) -> bool {
        self.absent(commit, file).exists()
    }

    /// Keeps that a commit lacks a file, so that nobody asks again.
    pub(super) fn keep_absent(&self, commit: &Commit, file: &str) -> Result<(), LocalError> {
        let path = self.absent(commit, file);
        make_parent(&path)?;
        File::create(&path).map(drop).map_err(|error| LocalError::io(&path, "write", error))
    }

    fn absent(&self, commit: &Commit, file: &str) -> PathBuf {
        self.root.join(".no_exist").join(commit.as_str()).join(file)
    }

    /// Waits until nobody else fetches the bytes of a hash. Others wait until the returned file is closed.
    pub(super) fn lock(&self, hash: &BlobHash, waiting: impl FnOnce()) -> Result<File, LocalError> {
        let path = self.locks.join(format!("{}.lock", hash.as_str()));
        make_parent(&path)?;
        let wrong = |error| LocalError::io(&path, "lock", error);
        let file = OpenOptions::new().create(true).append(true).open(&path).map_err(wrong)?;
        let locked = match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                waiting();
                file.lock()
            }
            Err(TryLockError::Error(error)) => Err(error),
            Ok(()) => Ok(()),
        };
        match locked {
            // Some network drives have no locks. Two processes may then spoil each other's download, which the hash tells.
            Err(error) if error.kind() == io::ErrorKind::Unsupported => Ok(file),
            other => other.map(|()| file).map_err(wrong),
        }
    }

    /// Puts bytes into a snapshot under a file's name.
    pub(super) fn link(
        &self,
        hash: &BlobHash,
        commit: &Commit,
        file: &str,
        symlinks: bool,
    ) -> Result<PathBuf, LocalError> {
        let (blob, path) = (self.blob(hash), self.snapshot(commit.as_str()).join(file));
        if path.is_file() {
            return Ok(path);
        }
        make_parent(&path)?;
        let io = |error| LocalError::io(&path, "write", error);
        // Made beside it and moved there: somebody else may make the same link right now.
        let fresh = fresh_beside(&path);
        // From snapshots/COMMIT/FILE it is two folders up, and one more for each folder in FILE.
        let up = "../".repeat(2 + file.matches('/').count());
        let links = || symlink(Path::new(&format!("{up}blobs/{}", hash.as_str())), &fresh).is_ok() && fresh.is_file();
        if !(symlinks && links()) {
            // What is left of a link that leads nowhere would be copied through.
            let _ = fs::remove_file(&fresh);
            fs::copy(&blob, &fresh).map_err(io)?;
        }
        fs::rename(&fresh, &path).map_err(io)?;
        Ok(path)
    }
}

/// A name for a file that nobody else makes, in this process or another, beside the path that it is for.
fn fresh_beside(path: &Path) -> PathBuf {
    static MADE: AtomicU64 = AtomicU64::new(0);
    beside(path, &format!(".{}-{}.tmp", std::process::id(), MADE.fetch_add(1, Ordering::Relaxed)))
}

/// The same path with something behind its name.
pub(super) fn beside(path: &Path, end: &str) -> PathBuf {
    let mut text = path.as_os_str().to_owned();
    text.push(end);
    PathBuf::from(text)
}

/// Makes the folder that a path lies in.
pub(super) fn make_parent(path: &Path) -> Result<(), LocalError> {
    let Some(folder) = path.parent() else { return Ok(()) };
    fs::create_dir_all(folder).map_err(|error| LocalError::io(folder, "make the folder", error))
}

#[cfg(unix)]
fn symlink(to: &Path, at: &Path) -> io::Result<()> {
    std::os::unix::fs::symlink(to, at)
}

#[cfg(windows)]
fn symlink(to: &Path, at: &Path) -> io::Result<()> {
    std::os::windows::fs::symlink_file(to, at)
}

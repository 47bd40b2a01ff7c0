//! The cache on disk: its folders, which are those of the hub's own client, and the hashes that name its files.

use super::name::{HubModelName, is_name_part};
use crate::LocalError;
use serde::Serialize;
use sha1::Sha1;
use sha2::{Digest, Sha256};
use std::{
    fs::{self, File, OpenOptions, TryLockError},
    io::{self, BufReader, Read},
    path::{Path, PathBuf},
    sync::atomic::{AtomicU64, Ordering},
};

/// The most levels of folders that are searched; deeper files are ignored. Snapshots and references have few levels.
const MAX_FOLDER_DEPTH: usize = 8;

/// The hash of a commit: 40 hex digits in lower case. It is checked strictly, because it names a folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct CommitHash(String);

impl CommitHash {
    pub(super) fn parse(text: &str) -> Option<Self> {
        is_hex(text, 40).then(|| Self(text.to_owned()))
    }

    pub(super) fn as_str(&self) -> &str {
        &self.0
    }
}

/// The hash that a file must have. As text it is the name of the file's blob.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum BlobHash {
    /// The hub's hash of a large file.
    Sha256(String),
    /// The hub's hash of a small file: git's hash of a blob.
    Git(String),
}

impl BlobHash {
    /// Reads the hash from an etag. `None` if the etag is not a hash of the hub; such a file could not be checked.
    pub(super) fn from_etag(etag: &str) -> Option<Self> {
        let hash = etag.strip_prefix("W/").unwrap_or(etag).trim_matches('"');
        if is_hex(hash, 64) {
            Some(Self::Sha256(hash.to_owned()))
        } else {
            is_hex(hash, 40).then(|| Self::Git(hash.to_owned()))
        }
    }

    pub(super) fn as_str(&self) -> &str {
        match self {
            Self::Sha256(hash) | Self::Git(hash) => hash,
        }
    }

    /// Whether a file has this hash.
    pub(super) fn matches_file(&self, path: &Path) -> io::Result<bool> {
        let file = File::open(path)?;
        let length = file.metadata()?.len();
        let mut file = BufReader::with_capacity(1 << 20, file);
        let found = match self {
            Self::Sha256(_) => {
                let mut hasher = Sha256::new();
                io::copy(&mut file, &mut hasher)?;
                format!("{:x}", hasher.finalize())
            }
            Self::Git(_) => {
                let mut hasher = Sha1::new().chain_update(format!("blob {length}\0"));
                io::copy(&mut file, &mut hasher)?;
                format!("{:x}", hasher.finalize())
            }
        };
        Ok(found == self.as_str())
    }
}

/// Whether a text is this number of hex digits in lower case.
fn is_hex(text: &str, digits: usize) -> bool {
    text.len() == digits && text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
}

/// One model's part of the cache.
#[derive(Debug)]
pub(super) struct RepoFolder {
    /// The folder with `refs`, `blobs` and `snapshots`.
    root: PathBuf,
    /// The folder with the lock files.
    locks: PathBuf,
}

impl RepoFolder {
    pub(super) fn new(cache: &Path, model: &HubModelName) -> Self {
        let name = format!("models--{}--{}", model.org, model.name);
        Self { root: cache.join(&name), locks: cache.join(".locks").join(name) }
    }

    /// The folder of a commit's files.
    pub(super) fn snapshot_folder(&self, commit: &str) -> PathBuf {
        self.root.join("snapshots").join(commit)
    }

    /// The path of the file with this hash.
    pub(super) fn blob_path(&self, hash: &BlobHash) -> PathBuf {
        self.root.join("blobs").join(hash.as_str())
    }

    /// The commit that a revision (a branch, tag or commit) pointed to when it was fetched.
    pub(super) fn find_commit(&self, revision: &str) -> Option<CommitHash> {
        CommitHash::parse(revision).or_else(|| read_ref(&self.root.join("refs").join(revision)))
    }

    /// Records the commit that a revision points to.
    pub(super) fn keep_ref(&self, revision: &str, commit: &CommitHash) -> Result<(), LocalError> {
        if self.find_commit(revision).as_ref() == Some(commit) {
            return Ok(());
        }
        let path = self.root.join("refs").join(revision);
        make_parent(&path)?;
        // The file is replaced as a whole, because another process may read it at the same time.
        let fresh = temporary_path(&path);
        fs::write(&fresh, commit.as_str()).map_err(|error| LocalError::from_io(&fresh, "write", error))?;
        fs::rename(&fresh, &path).map_err(|error| LocalError::from_io(&path, "write", error))
    }

    /// Whether a commit is known to lack a file.
    pub(super) fn is_absent(&self, commit: &CommitHash, file: &str) -> bool {
        self.absence_path(commit, file).exists()
    }

    /// Records that a commit lacks a file, so that the hub is not asked again.
    pub(super) fn keep_absent(&self, commit: &CommitHash, file: &str) -> Result<(), LocalError> {
        let path = self.absence_path(commit, file);
        make_parent(&path)?;
        File::create(&path).map(drop).map_err(|error| LocalError::from_io(&path, "write", error))
    }

    fn absence_path(&self, commit: &CommitHash, file: &str) -> PathBuf {
        self.root.join(".no_exist").join(commit.as_str()).join(file)
    }

    /// Waits until no other process fetches the file of a hash. Others wait until the returned file is closed.
    /// `waiting` is called if this process has to wait.
    pub(super) fn lock_blob(&self, hash: &BlobHash, waiting: impl FnOnce()) -> Result<File, LocalError> {
        let path = self.locks.join(format!("{}.lock", hash.as_str()));
        make_parent(&path)?;
        let wrong = |error| LocalError::from_io(&path, "lock", error);
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
            // Some network drives have no locks. There two processes may damage each other's download, and the hash
            // shows it.
            Err(error) if error.kind() == io::ErrorKind::Unsupported => Ok(file),
            other => other.map(|()| file).map_err(wrong),
        }
    }

    /// Puts a blob into a snapshot under a file's name: as a link, or as a copy without `symlinks` or where links fail.
    pub(super) fn link_blob(
        &self,
        hash: &BlobHash,
        commit: &CommitHash,
        file: &str,
        symlinks: bool,
    ) -> Result<PathBuf, LocalError> {
        let (blob, path) = (self.blob_path(hash), self.snapshot_folder(commit.as_str()).join(file));
        if path.is_file() {
            return Ok(path);
        }
        make_parent(&path)?;
        let io = |error| LocalError::from_io(&path, "write", error);
        // The link is made under another name and then moved, because another process may make it at the same time.
        let fresh = temporary_path(&path);
        // From snapshots/COMMIT/FILE, the link goes up two folders, and one more for each folder in FILE.
        let up = "../".repeat(2 + file.matches('/').count());
        let links =
            || make_symlink(Path::new(&format!("{up}blobs/{}", hash.as_str())), &fresh).is_ok() && fresh.is_file();
        if !(symlinks && links()) {
            // A broken link is removed first, because the copy would be written through it.
            let _ = fs::remove_file(&fresh);
            fs::copy(&blob, &fresh).map_err(io)?;
        }
        fs::rename(&fresh, &path).map_err(io)?;
        Ok(path)
    }
}

/// The commit that a file of `refs` names.
fn read_ref(path: &Path) -> Option<CommitHash> {
    let mut text = String::new();
    File::open(path).ok()?.take(100).read_to_string(&mut text).ok()?;
    CommitHash::parse(text.trim())
}

/// A new path in the same folder, which no other thread or process uses.
fn temporary_path(path: &Path) -> PathBuf {
    static TEMPORARY_FILE_COUNT: AtomicU64 = AtomicU64::new(0);
    path_with_suffix(
        path,
        &format!(".{}-{}.tmp", std::process::id(), TEMPORARY_FILE_COUNT.fetch_add(1, Ordering::Relaxed)),
    )
}

/// The path with `end` added to its file name.
pub(super) fn path_with_suffix(path: &Path, end: &str) -> PathBuf {
    let mut text = path.as_os_str().to_owned();
    text.push(end);
    PathBuf::from(text)
}

/// Makes the folder that a path is in.
pub(super) fn make_parent(path: &Path) -> Result<(), LocalError> {
    let Some(folder) = path.parent() else { return Ok(()) };
    fs::create_dir_all(folder).map_err(|error| LocalError::from_io(folder, "make the folder", error))
}

#[cfg(unix)]
fn make_symlink(to: &Path, at: &Path) -> io::Result<()> {
    std::os::unix::fs::symlink(to, at)
}

#[cfg(windows)]
fn make_symlink(to: &Path, at: &Path) -> io::Result<()> {
    std::os::windows::fs::symlink_file(to, at)
}

/// A model in the cache, at one commit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct CachedModel {
    /// The name of the model, `hf/ORG/NAME`.
    pub name: String,
    /// Branches and tags that point to the commit.
    pub revisions: Vec<String>,
    /// The commit, or the name of a folder that the user put there.
    pub commit: String,
    /// How many files there are.
    pub files: usize,
    /// The total length of the files, bytes.
    pub bytes: u64,
    /// The folder of the files.
    pub folder: PathBuf,
}

/// All models with a valid name. Models without an organisation, datasets and spaces are left out.
pub(super) fn list_models(cache: &Path) -> Result<Vec<CachedModel>, LocalError> {
    let mut models = Vec::new();
    for folder in list_entries(cache)? {
        let Some((org, name)) = folder.file_name().and_then(|name| name.to_str()).and_then(parse_repo_folder) else {
            continue;
        };
        let refs = read_refs(&folder.join("refs"))?;
        for snapshot in list_entries(&folder.join("snapshots"))? {
            let commit = snapshot.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            let lengths: Vec<u64> = list_files(&snapshot, MAX_FOLDER_DEPTH)?
                .iter()
                .filter_map(|file| Some(fs::metadata(file).ok()?.len()))
                .collect();
            if lengths.is_empty() {
                continue;
            }
            models.push(CachedModel {
                name: format!("hf/{org}/{name}"),
                revisions: refs.iter().filter(|(_, target)| *target == commit).map(|(name, _)| name.clone()).collect(),
                commit,
                files: lengths.len(),
                bytes: lengths.iter().sum(),
                folder: snapshot,
            });
        }
    }
    models.sort_by(|a, b| (&a.name, &a.commit).cmp(&(&b.name, &b.commit)));
    Ok(models)
}

/// The organisation and name of a model's folder.
fn parse_repo_folder(folder: &str) -> Option<(&str, &str)> {
    let (org, name) = folder.strip_prefix("models--")?.split_once("--")?;
    (is_name_part(org) && is_name_part(name)).then_some((org, name))
}

/// Branches and tags with their commits, in the order of their names.
fn read_refs(folder: &Path) -> Result<Vec<(String, String)>, LocalError> {
    let name = |file: &Path| Some(file.strip_prefix(folder).ok()?.to_str()?.replace('\\', "/"));
    let entry = |file: PathBuf| Some((name(&file)?, read_ref(&file)?.0));
    Ok(list_files(folder, MAX_FOLDER_DEPTH)?.into_iter().filter_map(entry).collect())
}

/// Every file below a folder, in the order of their paths.
fn list_files(folder: &Path, deepest: usize) -> Result<Vec<PathBuf>, LocalError> {
    let mut found = Vec::new();
    for path in list_entries(folder)? {
        if !path.is_dir() {
            found.push(path);
        } else if deepest > 0 {
            found.extend(list_files(&path, deepest - 1)?);
        }
    }
    Ok(found)
}

/// The entries of a folder, sorted; none if the folder does not exist.
fn list_entries(folder: &Path) -> Result<Vec<PathBuf>, LocalError> {
    let wrong = |error| LocalError::from_io(folder, "read", error);
    let read = match fs::read_dir(folder) {
        Ok(read) => read,
        Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => {
            return Ok(Vec::new());
        }
        Err(error) => return Err(wrong(error)),
    };
    let mut paths = read.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>().map_err(wrong)?;
    paths.sort();
    Ok(paths)
}

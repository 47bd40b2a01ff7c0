//! The marks of chunks in the run folder: `000012.done` records a finished chunk, `000012.dead` one that was given up.

use crate::{ChunkPlan, FileMarks, QueueError, folder::remove_if_there, put_new};
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeMap,
    fs,
    io::ErrorKind,
    path::{Path, PathBuf},
};

/// The folder of chunks and their marks in a run folder.
pub const CHUNKS_FOLDER: &str = "chunks";
/// Largest mark that is read, bytes. A larger file is an error.
const MAX_MARK_BYTES: u64 = 1 << 20;

/// The record of a finished chunk. Times, names and costs are here and not in the results, so that the
/// results do not depend on the worker that made them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChunkRecord {
    /// Its number.
    pub chunk: usize,
    /// The claim under which it was made; 0 in a shard.
    pub epoch: i64,
    /// Items that have texts, accepted or rejected.
    pub made: usize,
    /// Accepted texts.
    pub written: usize,
    /// Texts that failed their checks.
    pub rejected: usize,
    /// Items that failed, by reason.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub failed: BTreeMap<String, usize>,
    /// How long it took the worker that finished it, seconds.
    pub seconds: f64,
    /// What its calls cost that worker, US dollars.
    pub usd: f64,
    /// The worker that made it.
    pub worker: String,
    /// When it was finished, seconds since 1970.
    pub at_unix_s: u64,
    /// The run's name, as its plan has it. Empty in marks of older versions.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub run: String,
    /// Its files. Empty in marks of older versions, so that its files cannot be compared with it.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub files: FileMarks,
}

/// The mark of a finished chunk.
#[must_use]
pub fn done_path(folder: &Path, chunk: usize) -> PathBuf {
    folder.join(CHUNKS_FOLDER).join(format!("{chunk:06}.done"))
}

/// The mark of a chunk that was given up.
#[must_use]
pub fn dead_path(folder: &Path, chunk: usize) -> PathBuf {
    folder.join(CHUNKS_FOLDER).join(format!("{chunk:06}.dead"))
}

/// The file that counts how often a chunk of a shard was begun.
pub(crate) fn tries_path(folder: &Path, chunk: usize) -> PathBuf {
    done_path(folder, chunk).with_extension("tries")
}

/// The folder of a chunk's results. Each claim has its own folder, so that two workers never write into the same one.
#[must_use]
pub fn chunk_folder(folder: &Path, chunk: usize, epoch: i64) -> PathBuf {
    let name = if epoch == 0 { format!("{chunk:06}") } else { format!("{chunk:06}.{epoch}") };
    folder.join(CHUNKS_FOLDER).join(name)
}

/// The chunk whose results a folder of this name holds, as [`chunk_folder`] makes it. `None` for every other name in the folder of chunks.
#[must_use]
pub fn chunk_of_folder(name: &str) -> Option<usize> {
    let mut words = name.split('.').map(|word| word.parse::<usize>());
    match (words.next(), words.next()) {
        (Some(Ok(chunk)), None | Some(Ok(_))) => Some(chunk),
        _ => None,
    }
}

impl ChunkRecord {
    /// Writes the mark, unless there is one. Returns whether this one was written. The results have to be synced before.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write_mark(&self, folder: &Path) -> Result<bool, QueueError> {
        let path = done_path(folder, self.chunk);
        put_new(&path, &to_bytes(&path, self)?)
    }

    /// How many items failed.
    #[must_use]
    pub fn failed_items(&self) -> usize {
        self.failed.values().sum()
    }
}

/// A value as a line of JSON. `path` is the file that the line is for, for the error.
pub(crate) fn to_bytes(path: &Path, value: &impl Serialize) -> Result<Vec<u8>, QueueError> {
    let mut bytes = serde_json::to_vec(value)
        .map_err(|error| QueueError::Broken { path: path.to_owned(), problem: error.to_string() })?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// Reads a small file of JSON; `None` if there is none.
pub(crate) fn from_file<T: serde::de::DeserializeOwned>(path: &Path) -> Result<Option<T>, QueueError> {
    let broken = |problem: String| QueueError::Broken { path: path.to_owned(), problem };
    match fs::metadata(path) {
        Ok(about) if about.len() > MAX_MARK_BYTES => return Err(broken("it is larger than 1 MiB".to_owned())),
        Ok(_) => {}
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(QueueError::Io { path: path.to_owned(), doing: "read", source }),
    }
    let bytes = match fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(QueueError::Io { path: path.to_owned(), doing: "read", source }),
    };
    serde_json::from_slice(&bytes).map(Some).map_err(|error| broken(error.to_string()))
}

/// The record of a chunk; `None` if it is not finished.
///
/// # Errors
/// When its mark cannot be read.
pub fn read_done_mark(folder: &Path, chunk: usize) -> Result<Option<ChunkRecord>, QueueError> {
    from_file(&done_path(folder, chunk))
}

/// Why a chunk was given up; `None` if it was not.
///
/// # Errors
/// When its mark cannot be read.
pub fn read_dead_mark(folder: &Path, chunk: usize) -> Result<Option<String>, QueueError> {
    from_file(&dead_path(folder, chunk))
}

/// The chunks with failed items, or given up, for a reason that contains the text `reason`.
///
/// # Errors
/// When a mark cannot be read.
pub fn failing_chunks(folder: &Path, plan: &ChunkPlan, reason: &str) -> Result<Vec<usize>, QueueError> {
    let mut failing = Vec::new();
    for chunk in 0..plan.chunk_count() {
        let failed =
            read_done_mark(folder, chunk)?.is_some_and(|done| done.failed.keys().any(|why| why.contains(reason)));
        if failed || read_dead_mark(folder, chunk)?.is_some_and(|why| why.contains(reason)) {
            failing.push(chunk);
        }
    }
    Ok(failing)
}

/// Moves files of a chunk out of the way, into a folder of its own beside the chunk's, so that they are made again and the old ones
/// are not lost. Files that are missing are passed over. Returns that folder.
///
/// # Errors
/// When a file cannot be moved.
pub fn set_files_aside(folder: &Path, chunk: usize, epoch: i64, names: &[&str]) -> Result<PathBuf, QueueError> {
    let results = chunk_folder(folder, chunk, epoch);
    let free = (1..).map(|number| folder.join(CHUNKS_FOLDER).join(format!("{chunk:06}.damaged-{number}")));
    let mut aside = results.clone();
    for path in free {
        match fs::create_dir(&path) {
            Ok(()) => {
                aside = path;
                break;
            }
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(source) => return Err(QueueError::Io { path, doing: "make the folder", source }),
        }
    }
    for name in names {
        let from = results.join(name);
        match fs::rename(&from, aside.join(name)) {
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(QueueError::for_file(from, "move")(error)),
            _ => {}
        }
    }
    Ok(aside)
}

/// Makes chunks open again. Their results stay, and the next worker tries only the failed items.
///
/// # Errors
/// When a mark cannot be removed.
pub fn reopen_chunks(folder: &Path, chunks: &[usize]) -> Result<(), QueueError> {
    for chunk in chunks {
        for mark in [done_path(folder, *chunk), dead_path(folder, *chunk), tries_path(folder, *chunk)] {
            remove_if_there(&mark)?;
        }
    }
    Ok(())
}

//! A board without a server: each worker has a fixed part of the chunks, and the state is in files of a shared folder.

use crate::{
    ChunkBoard, ChunkClaim, ChunkPlan, ChunkRecord, HeartbeatThread, MAX_CHUNK_TRIES, QueueError, RemainingChunks,
    marks::{chunk_folder, dead_path, done_path, from_file, to_bytes, tries_path},
    put_new, put_whole,
};
use serde::{Deserialize, Serialize};
use std::{cell::Cell, fmt, fs, path::Path, str::FromStr};

/// Part `k` of `n`: the chunks with a number that is `k` modulo `n`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShardPart {
    /// The number of the part, from 0.
    pub k: usize,
    /// How many parts there are.
    pub n: usize,
}

impl FromStr for ShardPart {
    type Err = QueueError;

    fn from_str(typed: &str) -> Result<Self, QueueError> {
        let wrong = |problem| QueueError::Part { typed: typed.to_owned(), problem };
        let (k, n) = typed.split_once('/').ok_or_else(|| wrong("there is no slash"))?;
        let number = |text: &str| text.trim().parse().map_err(|_| wrong("these are no two numbers"));
        let (k, n) = (number(k)?, number(n)?);
        if k >= n {
            return Err(wrong("the first number is not smaller than the second"));
        }
        Ok(Self { k, n })
    }
}

impl fmt::Display for ShardPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.k, self.n)
    }
}

impl ShardPart {
    /// The name of its heartbeat's file.
    #[must_use]
    pub fn heartbeat_name(self) -> String {
        format!("shard-{}-of-{}", self.k, self.n)
    }

    /// Whether a heartbeat file belongs to a worker with another `n`. Its part may have chunks in common with this one.
    #[must_use]
    pub fn overlaps_part(self, name: &str) -> bool {
        !name.ends_with(&format!("-of-{}", self.n))
    }

    /// The numbers of its chunks.
    pub fn chunk_numbers(self, plan: &ChunkPlan) -> impl Iterator<Item = usize> + use<> {
        (self.k..plan.chunk_count()).step_by(self.n)
    }
}

/// How often a chunk was begun.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct ChunkTries {
    /// How often it was begun without adding results.
    tries: i32,
    /// Bytes of results when it was begun last: a chunk that makes progress is not given up.
    bytes: u64,
}

/// A part of a run as a board. Only this worker writes its chunks.
#[derive(Debug)]
pub struct ShardBoard<'a> {
    folder: &'a Path,
    plan: &'a ChunkPlan,
    part: ShardPart,
    /// The heartbeat of this worker.
    heart: &'a HeartbeatThread,
    /// Every chunk of the part before this one was finished or given up when it was last checked.
    from: Cell<usize>,
}

impl<'a> ShardBoard<'a> {
    /// A board of the worker that has this part and this heartbeat.
    #[must_use]
    pub fn new(folder: &'a Path, plan: &'a ChunkPlan, part: ShardPart, heart: &'a HeartbeatThread) -> Self {
        Self { folder, plan, part, heart, from: Cell::new(0) }
    }

    /// Whether a chunk is finished or given up.
    fn is_over(&self, chunk: usize) -> bool {
        done_path(self.folder, chunk).exists() || dead_path(self.folder, chunk).exists()
    }

    /// Begins the first chunk, from a number on, that is neither finished nor given up.
    fn begin_from(&self, from: usize) -> Result<Option<ChunkClaim>, QueueError> {
        for chunk in self.part.chunk_numbers(self.plan).skip_while(|chunk| *chunk < from) {
            if self.is_over(chunk) {
                continue;
            }
            let results = chunk_folder(self.folder, chunk, 0);
            fs::create_dir_all(&results).map_err(QueueError::for_file(&results, "make the folder"))?;
            let before: ChunkTries = from_file(&tries_path(self.folder, chunk))?.unwrap_or_default();
            let bytes = bytes_in(&results);
            // After a try that added results, counting starts anew.
            let tries = if bytes > before.bytes { 0 } else { before.tries };
            if tries >= MAX_CHUNK_TRIES {
                self.mark_dead(
                    chunk,
                    &format!("begun {MAX_CHUNK_TRIES} times without a result: its worker ended each time"),
                )?;
                continue;
            }
            self.write_tries(chunk, ChunkTries { tries: tries + 1, bytes })?;
            self.from.set(chunk);
            return Ok(Some(ChunkClaim { chunk, epoch: 0 }));
        }
        Ok(None)
    }

    fn write_tries(&self, chunk: usize, tries: ChunkTries) -> Result<(), QueueError> {
        let path = tries_path(self.folder, chunk);
        put_whole(&path, &to_bytes(&path, &tries)?)
    }

    fn mark_dead(&self, chunk: usize, reason: &str) -> Result<(), QueueError> {
        let path = dead_path(self.folder, chunk);
        put_new(&path, &to_bytes(&path, &reason)?).map(drop)
    }
}

impl ChunkBoard for ShardBoard<'_> {
    fn take_chunk(&self) -> Result<Option<ChunkClaim>, QueueError> {
        self.heart.check_heartbeat()?;
        // Each check of a mark is a request to a network file system. So the chunks before the last one are checked again
        // only at the end, because they may have been opened again meanwhile.
        match self.begin_from(self.from.get())? {
            None if self.from.get() > 0 => self.begin_from(0),
            begun => Ok(begun),
        }
    }

    fn complete_chunk(&self, claimed: ChunkClaim, done: &ChunkRecord) -> Result<bool, QueueError> {
        self.heart.check_heartbeat()?;
        ChunkRecord { chunk: claimed.chunk, ..done.clone() }.write_mark(self.folder)
    }

    fn hand_back(&self, claimed: ChunkClaim) -> Result<(), QueueError> {
        let before: ChunkTries = from_file(&tries_path(self.folder, claimed.chunk))?.unwrap_or_default();
        self.write_tries(claimed.chunk, ChunkTries { tries: (before.tries - 1).max(0), ..before })
    }

    fn give_up(&self, claimed: ChunkClaim, reason: &str) -> Result<(), QueueError> {
        let before: ChunkTries = from_file(&tries_path(self.folder, claimed.chunk))?.unwrap_or_default();
        if before.tries >= MAX_CHUNK_TRIES { self.mark_dead(claimed.chunk, reason) } else { Ok(()) }
    }

    fn count_remaining(&self) -> Result<RemainingChunks, QueueError> {
        let open = self.part.chunk_numbers(self.plan).filter(|chunk| !self.is_over(*chunk)).count();
        Ok(RemainingChunks { open, running: 0 })
    }
}

/// Bytes of the plain files in a folder.
fn bytes_in(folder: &Path) -> u64 {
    let files = fs::read_dir(folder).into_iter().flatten().flatten();
    files.filter_map(|entry| entry.metadata().ok()).filter(fs::Metadata::is_file).map(|about| about.len()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{HEARTBEAT_LEASE, WorkerHeartbeat, failing_chunks, read_dead_mark, reopen_chunks};

    #[test]
    fn parts_are_read_and_together_they_are_the_whole() {
        assert_eq!("3/64".parse::<ShardPart>().unwrap(), ShardPart { k: 3, n: 64 });
        for bad in ["3", "64/64", "a/b", "-1/3", "1/0", ""] {
            assert!(bad.parse::<ShardPart>().is_err(), "{bad}");
        }
        let plan = ChunkPlan::new("r".into(), 1, String::new(), vec![String::new(); 10]);
        let mut all: Vec<usize> =
            (0..3).flat_map(|k| ShardPart { k, n: 3 }.chunk_numbers(&plan).collect::<Vec<_>>()).collect();
        all.sort_unstable();
        assert_eq!(all, (0..10).collect::<Vec<_>>());
    }

    #[test]
    fn take_gives_up_a_chunk_that_ends_its_worker_each_time() {
        let folder = tempfile::tempdir().unwrap();
        let plan = ChunkPlan::new("r".into(), 1, String::new(), vec![String::new(); 2]);
        let part = ShardPart { k: 0, n: 1 };
        let beat = WorkerHeartbeat::of_this_process("w", String::new());
        let heart =
            HeartbeatThread::start(folder.path(), &part.heartbeat_name(), beat, HEARTBEAT_LEASE, |_| false).unwrap();
        let shard = ShardBoard::new(folder.path(), &plan, part, &heart);
        for _ in 0..MAX_CHUNK_TRIES {
            assert_eq!(shard.take_chunk().unwrap().unwrap().chunk, 0);
        }
        assert_eq!(shard.take_chunk().unwrap().unwrap().chunk, 1, "the rest goes on");
        assert!(read_dead_mark(folder.path(), 0).unwrap().unwrap().contains("3 times"));
        assert_eq!(failing_chunks(folder.path(), &plan, "3 times").unwrap(), [0]);
        reopen_chunks(folder.path(), &[0]).unwrap();
        assert_eq!(shard.take_chunk().unwrap().unwrap().chunk, 1, "what is left comes first");
        shard
            .complete_chunk(ChunkClaim { chunk: 1, epoch: 0 }, &ChunkRecord { chunk: 1, ..ChunkRecord::default() })
            .unwrap();
        // A chunk that gets on is not given up, however often its worker is killed.
        for number in 0..2 * MAX_CHUNK_TRIES {
            assert_eq!(shard.take_chunk().unwrap().unwrap().chunk, 0);
            fs::write(chunk_folder(folder.path(), 0, 0).join(number.to_string()), "more").unwrap();
        }
        let done = ChunkRecord { chunk: 0, ..ChunkRecord::default() };
        assert!(shard.complete_chunk(ChunkClaim { chunk: 0, epoch: 0 }, &done).unwrap());
        assert!(!shard.complete_chunk(ChunkClaim { chunk: 0, epoch: 0 }, &done).unwrap());
        assert!(shard.take_chunk().unwrap().is_none());
        assert_eq!(shard.count_remaining().unwrap().open, 0);
    }
}

//! A board without a server: each worker has a fixed part of the chunks, and the state is in files of a shared folder.

use crate::{
    Board, Claimed, Done, Heart, Left, Plan, QueueError, TRIES,
    done::{chunk_folder, dead_path, done_path, from_file, to_bytes},
    put_new, put_whole,
};
use serde::{Deserialize, Serialize};
use std::{
    cell::Cell,
    fmt, fs,
    path::{Path, PathBuf},
    str::FromStr,
};

/// Part `k` of `n`: the chunks with a number that is `k` modulo `n`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// From 0.
    pub k: usize,
    /// How many parts there are.
    pub n: usize,
}

impl FromStr for Part {
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

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.k, self.n)
    }
}

impl Part {
    /// The name of its heartbeat's file.
    #[must_use]
    pub fn name(self) -> String {
        format!("shard-{}-of-{}", self.k, self.n)
    }

    /// Whether a heartbeat file belongs to a worker with another `n`. Its part may have chunks in common with this one.
    #[must_use]
    pub fn overlaps(self, name: &str) -> bool {
        !name.ends_with(&format!("-of-{}", self.n))
    }

    /// The numbers of its chunks.
    pub fn chunks(self, plan: &Plan) -> impl Iterator<Item = usize> + use<> {
        (self.k..plan.chunks()).step_by(self.n)
    }
}

/// How often a chunk was begun.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct Tries {
    tries: i32,
    /// Bytes of results when it was begun last: a chunk that makes progress is not given up.
    bytes: u64,
}

pub(crate) fn tries_path(folder: &Path, chunk: usize) -> PathBuf {
    done_path(folder, chunk).with_extension("tries")
}

/// A part of a run as a board. Only this worker writes its chunks.
#[derive(Debug)]
pub struct Shard<'a> {
    folder: &'a Path,
    plan: &'a Plan,
    part: Part,
    heart: &'a Heart,
    /// Every chunk of the part before this one was finished or given up when it was last checked.
    from: Cell<usize>,
}

impl<'a> Shard<'a> {
    /// A board of the worker that has this part and this heartbeat.
    #[must_use]
    pub fn new(folder: &'a Path, plan: &'a Plan, part: Part, heart: &'a Heart) -> Self {
        Self { folder, plan, part, heart, from: Cell::new(0) }
    }

    fn is_over(&self, chunk: usize) -> bool {
        done_path(self.folder, chunk).exists() || dead_path(self.folder, chunk).exists()
    }

    /// Begins the first chunk, from a number on, that is neither finished nor given up.
    fn begin_from(&self, from: usize) -> Result<Option<Claimed>, QueueError> {
        for chunk in self.part.chunks(self.plan).skip_while(|chunk| *chunk < from) {
            if self.is_over(chunk) {
                continue;
            }
            let results = chunk_folder(self.folder, chunk, 0);
            fs::create_dir_all(&results).map_err(QueueError::io(&results, "make the folder"))?;
            let before: Tries = from_file(&tries_path(self.folder, chunk))?.unwrap_or_default();
            let bytes = bytes_in(&results);
            let tries = if bytes > before.bytes { 0 } else { before.tries };
            if tries >= TRIES {
                self.dies(chunk, &format!("begun {TRIES} times without a result: its worker ended each time"))?;
                continue;
            }
            self.count(chunk, Tries { tries: tries + 1, bytes })?;
            self.from.set(chunk);
            return Ok(Some(Claimed { chunk, epoch: 0 }));
        }
        Ok(None)
    }

    fn count(&self, chunk: usize, tries: Tries) -> Result<(), QueueError> {
        let path = tries_path(self.folder, chunk);
        put_whole(&path, &to_bytes(&path, &tries)?)
    }

    fn dies(&self, chunk: usize, reason: &str) -> Result<(), QueueError> {
        let path = dead_path(self.folder, chunk);
        put_new(&path, &to_bytes(&path, &reason)?).map(drop)
    }
}

impl Board for Shard<'_> {
    fn take(&self) -> Result<Option<Claimed>, QueueError> {
        self.heart.check()?;
        // Each check of a mark is a request to a network file system. So the chunks before the last one are checked again
        // only at the end, because they may have been opened again meanwhile.
        match self.begin_from(self.from.get())? {
            None if self.from.get() > 0 => self.begin_from(0),
            begun => Ok(begun),
        }
    }

    fn complete(&self, claimed: Claimed, done: &Done) -> Result<bool, QueueError> {
        self.heart.check()?;
        Done { chunk: claimed.chunk, ..done.clone() }.put(self.folder)
    }

    fn hand_back(&self, claimed: Claimed) -> Result<(), QueueError> {
        let before: Tries = from_file(&tries_path(self.folder, claimed.chunk))?.unwrap_or_default();
        self.count(claimed.chunk, Tries { tries: (before.tries - 1).max(0), ..before })
    }

    fn give_up(&self, claimed: Claimed, reason: &str) -> Result<(), QueueError> {
        let before: Tries = from_file(&tries_path(self.folder, claimed.chunk))?.unwrap_or_default();
        if before.tries >= TRIES { self.dies(claimed.chunk, reason) } else { Ok(()) }
    }

    fn left(&self) -> Result<Left, QueueError> {
        let open = self.part.chunks(self.plan).filter(|chunk| !self.is_over(*chunk)).count();
        Ok(Left { open, running: 0 })
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
    use crate::{Beat, FRESH, dead_of, failing, reopen};

    #[test]
    fn parts_are_read_and_together_they_are_the_whole() {
        assert_eq!("3/64".parse::<Part>().unwrap(), Part { k: 3, n: 64 });
        for bad in ["3", "64/64", "a/b", "-1/3", "1/0", ""] {
            assert!(bad.parse::<Part>().is_err(), "{bad}");
        }
        let plan = Plan::new("r".into(), 1, String::new(), vec![String::new(); 10]);
        let mut all: Vec<usize> = (0..3).flat_map(|k| Part { k, n: 3 }.chunks(&plan).collect::<Vec<_>>()).collect();
        all.sort_unstable();
        assert_eq!(all, (0..10).collect::<Vec<_>>());
    }

    #[test]
    fn take_gives_up_a_chunk_that_ends_its_worker_each_time() {
        let folder = tempfile::tempdir().unwrap();
        let plan = Plan::new("r".into(), 1, String::new(), vec![String::new(); 2]);
        let part = Part { k: 0, n: 1 };
        let beat = Beat { worker: "w".into(), token: "t".into(), part: String::new() };
        let heart = Heart::start(folder.path(), &part.name(), beat, FRESH, |_| false).unwrap();
        let shard = Shard::new(folder.path(), &plan, part, &heart);
        for _ in 0..TRIES {
            assert_eq!(shard.take().unwrap().unwrap().chunk, 0);
        }
        assert_eq!(shard.take().unwrap().unwrap().chunk, 1, "the rest goes on");
        assert!(dead_of(folder.path(), 0).unwrap().unwrap().contains("3 times"));
        assert_eq!(failing(folder.path(), &plan, "3 times").unwrap(), [0]);
        reopen(folder.path(), &[0]).unwrap();
        assert_eq!(shard.take().unwrap().unwrap().chunk, 1, "what is left comes first");
        shard.complete(Claimed { chunk: 1, epoch: 0 }, &Done { chunk: 1, ..Done::default() }).unwrap();
        // A chunk that gets on is not given up, however often its worker is killed.
        for number in 0..2 * TRIES {
            assert_eq!(shard.take().unwrap().unwrap().chunk, 0);
            fs::write(chunk_folder(folder.path(), 0, 0).join(number.to_string()), "more").unwrap();
        }
        let done = Done { chunk: 0, ..Done::default() };
        assert!(shard.complete(Claimed { chunk: 0, epoch: 0 }, &done).unwrap());
        assert!(!shard.complete(Claimed { chunk: 0, epoch: 0 }, &done).unwrap());
        assert!(shard.take().unwrap().is_none());
        assert_eq!(shard.left().unwrap().open, 0);
    }
}

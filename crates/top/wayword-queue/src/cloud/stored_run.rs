//! A run whose folder is in an object store.

use super::{Bucket, Fetched};
use crate::{
    Board, Claimed, Done, Left, Plan, QueueError, chunk_folder,
    done::{CHUNKS, done_path},
    put_whole,
};
use std::{
    collections::BTreeSet,
    fs,
    io::ErrorKind,
    path::{Path, PathBuf},
};

/// Where marks are: as in the folder. What is listed often must not lie among the results.
const MARKS: &str = CHUNKS;
/// Where the results of chunks are.
const RESULTS: &str = "results";
/// Largest file that is written once, bytes: a plan of ten million items.
const MOST_BYTES: u64 = 1 << 30;
/// Largest run that is fetched, bytes.
const MOST_RUN_BYTES: u64 = 1 << 44;

/// A run in an object store. A worker works in a folder of its machine, sends each chunk's results when they are finished, and
/// then says so in the store by a mark, which is written once.
#[derive(Debug)]
pub struct StoredRun {
    bucket: Bucket,
    folder: PathBuf,
}

impl StoredRun {
    /// A run at an address, and the folder of this machine in which this worker, and no other, works on it.
    ///
    /// # Errors
    /// When the address cannot be used or the folder cannot be made.
    pub fn open(address: &str, folder: &Path) -> Result<Self, QueueError> {
        let bucket = Bucket::open(address)?;
        fs::create_dir_all(folder.join(CHUNKS)).map_err(QueueError::io(folder, "make the folder"))?;
        Ok(Self { bucket, folder: folder.to_owned() })
    }

    /// Makes sure that the store lets one of several writers win.
    ///
    /// # Errors
    /// When it does not, or cannot be used.
    pub fn check(&self) -> Result<(), QueueError> {
        Ok(self.bucket.check_put_new()?)
    }

    /// Takes a file from the store, if it is there.
    ///
    /// # Errors
    /// When the store or the folder cannot be used.
    pub fn take(&self, name: &str) -> Result<(), QueueError> {
        match self.bucket.get(name, MOST_BYTES)? {
            Some(bytes) => put_whole(&self.folder.join(name), &bytes),
            None => Ok(()),
        }
    }

    /// Sends a file that is written once, and takes the store's if another worker was first.
    ///
    /// # Errors
    /// When the file cannot be read or the store cannot be used.
    pub fn agree(&self, name: &str) -> Result<(), QueueError> {
        let path = self.folder.join(name);
        let bytes = fs::read(&path).map_err(QueueError::io(&path, "read"))?;
        match self.bucket.put_new(name, bytes)? {
            true => Ok(()),
            false => self.take(name),
        }
    }

    /// Takes the marks of finished chunks that are not here yet. Returns the numbers of all that are there.
    ///
    /// # Errors
    /// When the store or the folder cannot be used.
    pub fn take_marks(&self, plan: &Plan) -> Result<BTreeSet<usize>, QueueError> {
        let there: BTreeSet<String> = self.bucket.list(MARKS)?.into_iter().map(|entry| entry.name).collect();
        let done: BTreeSet<usize> = (0..plan.chunks()).filter(|chunk| there.contains(&self.mark(*chunk))).collect();
        for chunk in &done {
            if !done_path(&self.folder, *chunk).exists() {
                self.take(&self.mark(*chunk))?;
            }
        }
        Ok(done)
    }

    /// Sends the marks that are here and not in the store: their worker was killed between the two.
    ///
    /// # Errors
    /// When the store or the folder cannot be used.
    pub fn send_marks(&self, plan: &Plan) -> Result<(), QueueError> {
        let done = self.take_marks(plan)?;
        (0..plan.chunks())
            .filter(|chunk| !done.contains(chunk) && done_path(&self.folder, *chunk).exists())
            .try_for_each(|chunk| self.agree(&self.mark(chunk)))
    }

    /// Removes the mark of a chunk, so that it is made again.
    ///
    /// # Errors
    /// When the store cannot be used.
    pub fn reopen(&self, chunk: usize) -> Result<(), QueueError> {
        Ok(self.bucket.remove(&self.mark(chunk))?)
    }

    /// Fetches the whole run: plan, marks and results. Continues where it was stopped.
    ///
    /// # Errors
    /// When the store or the folder cannot be used.
    pub fn fetch(&self, plan: &Plan, progress: &dyn Fn(u64, u64)) -> Result<Fetched, QueueError> {
        // The marks first: what has one is there as a whole.
        self.take_marks(plan)?;
        Ok(self.bucket.fetch_folder(RESULTS, &self.folder.join(CHUNKS), MOST_RUN_BYTES, progress)?)
    }

    /// A board that sends results before it says that a chunk is finished.
    #[must_use]
    pub fn sending<'a>(&'a self, board: &'a dyn Board) -> Sending<'a> {
        Sending { run: self, board }
    }

    /// The name of a chunk's mark, here and in the store.
    fn mark(&self, chunk: usize) -> String {
        name_in(&self.folder, &done_path(&self.folder, chunk))
    }
}

/// The name that a file of the run has in the store.
fn name_in(folder: &Path, path: &Path) -> String {
    let parts = path.strip_prefix(folder).unwrap_or(path).components();
    parts.map(|part| part.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/")
}

/// A board whose chunks' results go into an object store.
pub struct Sending<'a> {
    run: &'a StoredRun,
    board: &'a dyn Board,
}

impl Board for Sending<'_> {
    fn take(&self) -> Result<Option<Claimed>, QueueError> {
        self.board.take()
    }

    fn complete(&self, claimed: Claimed, done: &Done) -> Result<bool, QueueError> {
        let results = chunk_folder(&self.run.folder, claimed.chunk, claimed.epoch);
        let name = name_in(&self.run.folder.join(CHUNKS), &results);
        self.run.bucket.send_folder(&results, &format!("{RESULTS}/{name}"))?;
        let holds = self.board.complete(claimed, done)?;
        if holds {
            // A second worker of the same part has made the same results.
            self.run.agree(&self.run.mark(claimed.chunk))?;
        }
        match fs::remove_dir_all(&results) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(QueueError::io(&results, "remove")(error)),
            _ => Ok(holds),
        }
    }

    fn hand_back(&self, claimed: Claimed) -> Result<(), QueueError> {
        self.board.hand_back(claimed)
    }

    fn give_up(&self, claimed: Claimed, reason: &str) -> Result<(), QueueError> {
        self.board.give_up(claimed, reason)
    }

    fn left(&self) -> Result<Left, QueueError> {
        self.board.left()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Beat, FRESH, Heart, PLAN, Part, Shard, done_of};

    #[test]
    fn what_a_worker_sends_is_fetched_as_it_was_and_a_second_worker_finds_nothing_to_do() {
        let (there, first, second, all) = (folder(), folder(), folder(), folder());
        let address = format!("file://{}", there.path().display());
        let plan = Plan::new("r".into(), 1, String::new(), vec![String::new(); 3]);
        let run = StoredRun::open(&address, first.path()).unwrap();
        run.check().unwrap();
        plan.put(first.path()).unwrap();
        run.agree(PLAN).unwrap();
        assert_eq!(make_all(&run, &plan), [0, 1, 2]);
        assert!(!chunk_folder(first.path(), 0, 0).exists(), "a machine's disk need not hold the run");

        // Another plan is not taken: the store's counts.
        let other = StoredRun::open(&address, second.path()).unwrap();
        Plan::new("other".into(), 1, String::new(), Vec::new()).put(second.path()).unwrap();
        other.agree(PLAN).unwrap();
        assert_eq!(Plan::of(second.path()).unwrap(), plan);
        assert_eq!(other.take_marks(&plan).unwrap().len(), 3);
        assert!(make_all(&other, &plan).is_empty());

        other.reopen(1).unwrap();
        let whole = StoredRun::open(&address, all.path()).unwrap();
        assert_eq!(whole.fetch(&plan, &|_, _| ()).unwrap().files, 3);
        for chunk in [0, 2] {
            assert_eq!(done_of(all.path(), chunk).unwrap().unwrap().chunk, chunk);
            assert_eq!(
                fs::read_to_string(chunk_folder(all.path(), chunk, 0).join("texts")).unwrap(),
                chunk.to_string()
            );
        }
        assert!(done_of(all.path(), 1).unwrap().is_none(), "it is to be made again");
        // A worker that was killed before it sent a mark: the next one does.
        Done { chunk: 1, ..Done::default() }.put(second.path()).unwrap();
        other.send_marks(&plan).unwrap();
        assert_eq!(whole.take_marks(&plan).unwrap().len(), 3);
    }

    fn folder() -> tempfile::TempDir {
        tempfile::tempdir().unwrap()
    }

    fn make_all(run: &StoredRun, plan: &Plan) -> Vec<usize> {
        let part = Part { k: 0, n: 1 };
        let beat = Beat { worker: "w".into(), token: "t".into(), part: String::new() };
        let heart = Heart::start(&run.folder, &part.name(), beat, FRESH, |_| false).unwrap();
        let shard = Shard::new(&run.folder, plan, part, &heart);
        let board = run.sending(&shard);
        let mut made = Vec::new();
        while let Some(claimed) = board.take().unwrap() {
            let text = chunk_folder(&run.folder, claimed.chunk, claimed.epoch).join("texts");
            fs::write(text, claimed.chunk.to_string()).unwrap();
            assert!(board.complete(claimed, &Done { chunk: claimed.chunk, ..Done::default() }).unwrap());
            made.push(claimed.chunk);
        }
        made
    }
}

//! A run with its shared folder in an object store.
//!
//! Object stores have no rename and no locks. So results are sent first, each try under another prefix; then the chunk's
//! mark is made with put-if-absent. The mark names the try that counts. If two workers make the same chunk, the results of
//! the second one are never read.

use super::{CloudBucket, CloudError};
use crate::{
    ChunkBoard, ChunkClaim, ChunkPlan, ChunkRecord, PLAN, QueueError, RemainingChunks, chunk_folder,
    folder::remove_if_there,
    marks::{CHUNKS_FOLDER, done_path, read_done_mark, to_bytes},
    put_whole,
};
use std::{
    collections::BTreeSet,
    fs,
    io::ErrorKind,
    path::{Path, PathBuf},
    time::{SystemTime, UNIX_EPOCH},
};

/// The prefix of marks, the same as in the folder. Marks are listed often, so they must not be among the many results.
const MARKS_FOLDER: &str = CHUNKS_FOLDER;
/// The prefix of the results.
const RESULTS_FOLDER: &str = "results";
/// Largest file other than results that is fetched, bytes: enough for a plan of ten million items.
const MAX_FILE_BYTES: u64 = 1 << 30;
/// Largest results of a chunk that are fetched, bytes.
const MAX_CHUNK_BYTES: u64 = 1 << 40;

/// A run in an object store. A worker works in a folder of its machine, sends each chunk's results when they are finished, and
/// then makes a mark in the store. Each try has a prefix for its results, and the mark names that prefix.
#[derive(Debug)]
pub struct CloudRun {
    bucket: CloudBucket,
    /// The folder of this machine in which the worker works.
    folder: PathBuf,
}

impl CloudRun {
    /// A run at an address, and the folder of this machine in which this worker, and no other, works on it.
    ///
    /// # Errors
    /// When the address cannot be used or the folder cannot be made.
    pub fn open(address: &str, folder: &Path) -> Result<Self, QueueError> {
        let bucket = CloudBucket::open(address)?;
        fs::create_dir_all(folder.join(CHUNKS_FOLDER)).map_err(QueueError::for_file(folder, "make the folder"))?;
        Ok(Self { bucket, folder: folder.to_owned() })
    }

    /// Makes sure that the store makes one of several writers win.
    ///
    /// # Errors
    /// When it does not, or cannot be used.
    pub fn check_store(&self) -> Result<(), QueueError> {
        Ok(self.bucket.check_put_new()?)
    }

    /// Fetches a file, if the store has it.
    ///
    /// # Errors
    /// When the store or the folder cannot be used.
    pub fn fetch_file(&self, name: &str) -> Result<(), QueueError> {
        match self.bucket.get_object(name, MAX_FILE_BYTES)? {
            Some(bytes) => put_whole(&self.folder.join(name), &bytes),
            None => Ok(()),
        }
    }

    /// Sends a file that only one worker may write. If another worker was first, its file is fetched instead.
    ///
    /// # Errors
    /// When the file cannot be read or the store cannot be used.
    pub fn publish_file(&self, name: &str) -> Result<(), QueueError> {
        let path = self.folder.join(name);
        let bytes = fs::read(&path).map_err(QueueError::for_file(&path, "read"))?;
        match self.bucket.put_new(name, bytes)? {
            true => Ok(()),
            false => self.fetch_file(name),
        }
    }

    /// The numbers of the chunks that have a mark in the store.
    fn marked_chunks(&self, plan: &ChunkPlan) -> Result<BTreeSet<usize>, QueueError> {
        let stored: BTreeSet<String> =
            self.bucket.list_objects(MARKS_FOLDER)?.into_iter().map(|entry| entry.name).collect();
        Ok((0..plan.chunk_count()).filter(|chunk| stored.contains(&self.mark_name(*chunk))).collect())
    }

    /// Fetches the marks of finished chunks, in place of those in the folder.
    ///
    /// # Errors
    /// When the store or the folder cannot be used.
    pub fn fetch_marks(&self, plan: &ChunkPlan) -> Result<(), QueueError> {
        let marked = self.marked_chunks(plan)?;
        for chunk in 0..plan.chunk_count() {
            match marked.contains(&chunk) {
                true => self.fetch_file(&self.mark_name(chunk))?,
                // The chunk was opened again.
                false => remove_if_there(&done_path(&self.folder, chunk))?,
            }
        }
        Ok(())
    }

    /// Sends the marks of this folder that the store lacks: the worker of a queue can be killed after it has reported a chunk and
    /// before it sends the mark. The marks of this folder have to be those of the queue.
    ///
    /// # Errors
    /// When the store or the folder cannot be used.
    pub fn send_marks(&self, plan: &ChunkPlan) -> Result<(), QueueError> {
        let marked = self.marked_chunks(plan)?;
        for chunk in (0..plan.chunk_count()).filter(|chunk| !marked.contains(chunk)) {
            if let Some(done) = read_done_mark(&self.folder, chunk)? {
                self.put_mark(&done)?;
            }
        }
        Ok(())
    }

    /// Removes the mark of a chunk, so that it is made again.
    ///
    /// # Errors
    /// When the store cannot be used.
    pub fn reopen_chunk(&self, chunk: usize) -> Result<(), QueueError> {
        Ok(self.bucket.remove_object(&self.mark_name(chunk))?)
    }

    /// Fetches the plan, the marks and the results that the marks name into the folder. A fetch that was stopped is continued.
    /// `progress` gets the number of chunks so far, and of all chunks.
    ///
    /// # Errors
    /// When there is no run, the folder has another one, or the store or the folder cannot be used.
    pub fn fetch_run(&self, progress: &dyn Fn(usize, usize)) -> Result<(), QueueError> {
        let Some(bytes) = self.bucket.get_object(PLAN, MAX_FILE_BYTES)? else {
            return Err(QueueError::NoPlan(self.bucket.to_string().into()));
        };
        let path = self.folder.join(PLAN);
        match fs::read(&path) {
            Ok(before) if before != bytes => {
                let problem = "this folder has another run".to_owned();
                return Err(QueueError::Broken { path: self.folder.clone(), problem });
            }
            Ok(_) => {}
            Err(_) => put_whole(&path, &bytes)?,
        }
        let plan = ChunkPlan::for_folder(&self.folder)?;
        self.fetch_marks(&plan)?;
        for chunk in 0..plan.chunk_count() {
            if let Some(done) = read_done_mark(&self.folder, chunk)? {
                let local = chunk_folder(&self.folder, chunk, done.epoch);
                self.bucket.fetch_folder(&self.results_name(&local), &local, MAX_CHUNK_BYTES, &|_, _| ())?;
            }
            progress(chunk + 1, plan.chunk_count());
        }
        Ok(())
    }

    /// A board that sends the results of a chunk before it reports the chunk as finished.
    #[must_use]
    pub fn sending_board<'a>(&'a self, board: &'a dyn ChunkBoard) -> SendingBoard<'a> {
        SendingBoard { run: self, board }
    }

    /// The name of a chunk's mark, in the folder and in the store.
    fn mark_name(&self, chunk: usize) -> String {
        stored_name(&self.folder, &done_path(&self.folder, chunk))
    }

    /// Where the results of a try are, in the store.
    fn results_name(&self, local: &Path) -> String {
        format!("{RESULTS_FOLDER}/{}", stored_name(&self.folder.join(CHUNKS_FOLDER), local))
    }

    /// Makes the mark of a chunk. Returns whether the store's mark is now this one. A mark of an earlier claim of a queue is
    /// replaced: it was left behind when the chunk was opened again.
    fn put_mark(&self, done: &ChunkRecord) -> Result<bool, QueueError> {
        let (name, path) = (self.mark_name(done.chunk), done_path(&self.folder, done.chunk));
        let bytes = to_bytes(&path, done)?;
        if self.bucket.put_new(&name, bytes.clone())? {
            return Ok(true);
        }
        self.fetch_file(&name)?;
        match read_done_mark(&self.folder, done.chunk)? {
            Some(stored) if stored.epoch == done.epoch => Ok(true),
            // Another try of a shard was first, or the queue gave the chunk to another worker later.
            Some(stored) if is_try_number(done.epoch) || stored.epoch > done.epoch => Ok(false),
            _ => {
                self.bucket.put_object(&name, bytes)?;
                Ok(true)
            }
        }
    }
}

/// The name that a file of the run has in the store.
fn stored_name(folder: &Path, path: &Path) -> String {
    let parts = path.strip_prefix(folder).unwrap_or(path).components();
    parts.map(|part| part.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/")
}

/// The number of a try of a shard, which has no claims: microseconds since 1970. Two workers of one part cannot see each other in a
/// store; with these numbers they get two prefixes for their results.
fn new_try_number() -> i64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    i64::try_from(since.as_micros()).unwrap_or(i64::MAX).max(MIN_TRY_NUMBER)
}

/// The smallest number of a try. It is larger than any number of a claim, because no chunk is claimed so often.
const MIN_TRY_NUMBER: i64 = 1 << 40;

/// Whether this is the number of a try, and not the claim of a queue.
fn is_try_number(epoch: i64) -> bool {
    epoch >= MIN_TRY_NUMBER
}

/// The claim as the board behind a [`SendingBoard`] knows it: with epoch 0 if the board is a shard, which has no tries.
fn board_claim(claimed: ChunkClaim) -> ChunkClaim {
    if is_try_number(claimed.epoch) { ChunkClaim { epoch: 0, ..claimed } } else { claimed }
}

/// A board that sends the results of chunks into an object store.
pub struct SendingBoard<'a> {
    run: &'a CloudRun,
    board: &'a dyn ChunkBoard,
}

impl SendingBoard<'_> {
    /// Sends the results of a chunk. If that fails, the chunk is handed back.
    fn send_results(&self, claimed: ChunkClaim, results: &Path) -> Result<(), QueueError> {
        let sent = self.run.bucket.send_folder(results, &self.run.results_name(results));
        sent.map(drop).or_else(|error: CloudError| {
            // The failure has no connection with the chunk, so it does not count as a try.
            self.board.hand_back(board_claim(claimed))?;
            Err(error.into())
        })
    }
}

impl ChunkBoard for SendingBoard<'_> {
    fn take_chunk(&self) -> Result<Option<ChunkClaim>, QueueError> {
        let taken = self.board.take_chunk()?;
        Ok(taken.map(|taken| if taken.epoch == 0 { ChunkClaim { epoch: new_try_number(), ..taken } } else { taken }))
    }

    fn complete_chunk(&self, claimed: ChunkClaim, done: &ChunkRecord) -> Result<bool, QueueError> {
        let results = chunk_folder(&self.run.folder, claimed.chunk, claimed.epoch);
        self.send_results(claimed, &results)?;
        let counts = self.board.complete_chunk(board_claim(claimed), done)? && self.run.put_mark(done)?;
        if !is_try_number(claimed.epoch) {
            // The queue knows which chunks are finished, also after one was opened again. A local mark would be outdated then.
            remove_if_there(&done_path(&self.run.folder, claimed.chunk))?;
        }
        match fs::remove_dir_all(&results) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(QueueError::for_file(&results, "remove")(error)),
            _ => Ok(counts),
        }
    }

    fn hand_back(&self, claimed: ChunkClaim) -> Result<(), QueueError> {
        self.board.hand_back(board_claim(claimed))
    }

    fn give_up(&self, claimed: ChunkClaim, reason: &str) -> Result<(), QueueError> {
        self.board.give_up(board_claim(claimed), reason)
    }

    fn count_remaining(&self) -> Result<RemainingChunks, QueueError> {
        self.board.count_remaining()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{HEARTBEAT_LEASE, HeartbeatThread, ShardBoard, ShardPart, WorkerHeartbeat};

    fn folder() -> tempfile::TempDir {
        tempfile::tempdir().unwrap()
    }

    fn plan() -> ChunkPlan {
        ChunkPlan::new("r".into(), 1, String::new(), vec![String::new(); 3])
    }

    /// Makes the open chunks. Returns the number of each, and whether its results count.
    fn make_all(run: &CloudRun, text: &str) -> Vec<(usize, bool)> {
        let (plan, part) = (plan(), ShardPart { k: 0, n: 1 });
        let beat = WorkerHeartbeat::of_this_process("w", String::new());
        let heart =
            HeartbeatThread::start(&run.folder, &part.heartbeat_name(), beat, HEARTBEAT_LEASE, |_| false).unwrap();
        let shard = ShardBoard::new(&run.folder, &plan, part, &heart);
        let board = run.sending_board(&shard);
        let mut made = Vec::new();
        while let Some(claimed) = board.take_chunk().unwrap() {
            let results = chunk_folder(&run.folder, claimed.chunk, claimed.epoch);
            fs::create_dir_all(&results).unwrap();
            fs::write(results.join("texts"), text).unwrap();
            let done = ChunkRecord { chunk: claimed.chunk, epoch: claimed.epoch, ..ChunkRecord::default() };
            made.push((claimed.chunk, board.complete_chunk(claimed, &done).unwrap()));
            assert!(!results.exists(), "a machine's disk need not hold the run");
        }
        made
    }

    #[test]
    fn fetch_returns_the_results_of_the_first_worker() {
        let (there, first, second, all) = (folder(), folder(), folder(), folder());
        let address = format!("file://{}", there.path().display());
        let [run, other, whole] =
            [&first, &second, &all].map(|folder| CloudRun::open(&address, folder.path()).unwrap());
        run.check_store().unwrap();
        plan().write_plan(first.path()).unwrap();
        run.publish_file(PLAN).unwrap();
        // Another plan is not sent: the plan in the store is used.
        ChunkPlan::new("other".into(), 1, String::new(), Vec::new()).write_plan(second.path()).unwrap();
        other.publish_file(PLAN).unwrap();
        assert_eq!(ChunkPlan::for_folder(second.path()).unwrap(), plan());

        assert_eq!(make_all(&run, "first"), [(0, true), (1, true), (2, true)]);
        // Another worker of the same part, which does not see the first one: its results do not count.
        assert_eq!(make_all(&other, "second"), [(0, false), (1, false), (2, false)]);
        other.reopen_chunk(1).unwrap();
        other.fetch_marks(&plan()).unwrap();
        assert_eq!(make_all(&other, "second"), [(1, true)]);

        let texts = || {
            whole.fetch_run(&|_, _| ()).unwrap();
            (0..3)
                .map(|chunk| {
                    let done = read_done_mark(all.path(), chunk).unwrap()?;
                    Some(fs::read_to_string(chunk_folder(all.path(), chunk, done.epoch).join("texts")).unwrap())
                })
                .collect::<Vec<_>>()
        };
        let of = |text: &str| Some(text.to_owned());
        assert_eq!(texts(), [of("first"), of("second"), of("first")]);
        other.reopen_chunk(2).unwrap();
        assert_eq!(texts(), [of("first"), of("second"), None], "what is to be made again is not there");
    }

    #[test]
    fn put_replaces_the_mark_of_an_earlier_claim() {
        let (there, here) = (folder(), folder());
        let run = CloudRun::open(&format!("file://{}", there.path().display()), here.path()).unwrap();
        let done = |epoch| ChunkRecord { epoch, ..ChunkRecord::default() };
        let put = |epoch| run.put_mark(&done(epoch)).unwrap();
        assert_eq!([put(2), put(2), put(1), put(3), put(2)], [true, true, false, true, false]);
        run.fetch_marks(&plan()).unwrap();
        assert_eq!(read_done_mark(here.path(), 0).unwrap().unwrap().epoch, 3);
        // The queue has the chunk as finished, and the store has no mark of it.
        run.reopen_chunk(0).unwrap();
        run.send_marks(&plan()).unwrap();
        run.fetch_marks(&plan()).unwrap();
        assert_eq!(read_done_mark(here.path(), 0).unwrap().unwrap().epoch, 3);
    }
}

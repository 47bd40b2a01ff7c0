//! The one thread that writes a file of the ledger. Each commit has to wait for the disk, so the thread combines all writes that
//! arrived during the last commit into the next one.

use crate::{LedgerError, LedgerLocation};
use std::{
    path::{Path, PathBuf},
    sync::mpsc,
    thread::{self, JoinHandle},
};

/// How many writes the queue and one commit can contain. A sender waits while the queue is full, so that memory is bounded.
const MAX_GROUP_WRITES: usize = 1024;

/// Writes groups of writes to disk.
pub(super) trait GroupCommit: Send + 'static {
    /// A write.
    type Write: Send + 'static;
    /// The result of a write.
    type Outcome: Send + 'static;

    /// Makes a group of writes, and returns once all of them are on disk: the result of each, in their order.
    fn commit_group(&mut self, group: &[Self::Write]) -> Result<Vec<Self::Outcome>, LedgerError>;

    /// Called after the last group.
    fn finish(self);
}

/// A write on its way to the thread.
struct QueuedWrite<W, R> {
    write: W,
    /// Gets the result once the write is on disk, if a thread waits for it.
    done: Option<mpsc::SyncSender<Result<R, LedgerError>>>,
}

/// Passes writes to the writing thread. When it is dropped, all pending writes are finished first.
#[derive(Debug)]
pub(super) struct CommitQueue<W, R> {
    /// `None` once the queue is being dropped; then the thread ends.
    writes: Option<mpsc::SyncSender<QueuedWrite<W, R>>>,
    thread: Option<JoinHandle<()>>,
    path: PathBuf,
}

impl<W: Send + 'static, R: Send + 'static> CommitQueue<W, R> {
    /// Starts the thread that writes the file at `path`.
    pub(super) fn start(
        thread_name: &str,
        path: &Path,
        committer: impl GroupCommit<Write = W, Outcome = R>,
    ) -> Result<Self, LedgerError> {
        let (sender, writes) = mpsc::sync_channel(MAX_GROUP_WRITES);
        let thread = thread::Builder::new()
            .name(thread_name.to_owned())
            .spawn(move || run_commits(committer, &writes))
            .map_err(LedgerError::io_error(path, "start the ledger's thread"))?;
        Ok(Self { writes: Some(sender), thread: Some(thread), path: path.to_owned() })
    }

    /// Makes a write, and returns once it is on disk.
    pub(super) fn write_and_wait(&self, write: W) -> Result<R, LedgerError> {
        let (done, outcome) = mpsc::sync_channel(1);
        self.send(QueuedWrite { write, done: Some(done) });
        outcome.recv().unwrap_or_else(|_| Err(self.thread_ended_error()))
    }

    /// Makes a write with the next commit that succeeds, and does not wait for it.
    pub(super) fn queue_write(&self, write: W) {
        self.send(QueuedWrite { write, done: None });
    }

    fn send(&self, write: QueuedWrite<W, R>) {
        if let Some(writes) = &self.writes {
            // If the thread has ended, the caller that waits gets an error.
            let _ = writes.send(write);
        }
    }

    fn thread_ended_error(&self) -> LedgerError {
        LedgerError::Store {
            place: LedgerLocation::from_path(&self.path),
            doing: "write",
            reason: "the thread that writes it has ended".to_owned(),
            hint: "run the same command again",
            is_lost: false,
        }
    }
}

impl<W, R> Drop for CommitQueue<W, R> {
    fn drop(&mut self) {
        self.writes = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// The work of the writing thread, until the queue is dropped.
fn run_commits<C: GroupCommit>(mut committer: C, writes: &mpsc::Receiver<QueuedWrite<C::Write, C::Outcome>>) {
    let mut group = Vec::new();
    while let Ok(first) = writes.recv() {
        group.push(first);
        while group.len() < MAX_GROUP_WRITES {
            let Ok(next) = writes.try_recv() else { break };
            group.push(next);
        }
        group = commit_and_report(&mut committer, group);
    }
    // One more try for writes that have failed.
    if !group.is_empty() {
        commit_and_report(&mut committer, group);
    }
    committer.finish();
}

/// Commits a group, and passes the results to the threads that wait. Returns the failed writes that no thread waits for: they go
/// into the next commit.
fn commit_and_report<C: GroupCommit>(
    committer: &mut C,
    group: Vec<QueuedWrite<C::Write, C::Outcome>>,
) -> Vec<QueuedWrite<C::Write, C::Outcome>> {
    let (writes, waiting): (Vec<_>, Vec<_>) = group.into_iter().map(|queued| (queued.write, queued.done)).unzip();
    // A thread may no longer wait for its result.
    match committer.commit_group(&writes) {
        Ok(outcomes) => {
            for (done, outcome) in waiting.into_iter().zip(outcomes) {
                done.map(|done| done.send(Ok(outcome)));
            }
            Vec::new()
        }
        Err(error) => {
            let mut unwritten = Vec::new();
            for (write, done) in writes.into_iter().zip(waiting) {
                match done {
                    Some(done) => drop(done.send(Err(error.clone()))),
                    None => unwritten.push(QueuedWrite { write, done: None }),
                }
            }
            unwritten
        }
    }
}

//! The desk: the one thread that writes to the store for all requests.
//!
//! Each transaction waits for the disk, which takes milliseconds. So the thread puts all requests that wait at the same time into one
//! transaction (a group commit), and answers each of them only when the transaction is on disk.

use crate::{
    store::{StudyStore, StudyTransaction},
    study::{Study, StudyError},
};
use std::{
    sync::{Arc, mpsc},
    thread::{self, JoinHandle},
};
use tokio::sync::oneshot;

/// Most requests in one transaction.
const MAX_BATCH_REQUESTS: usize = 64;
/// Most requests in the queue. A further one fails with [`DeskError::Busy`].
const MAX_WAITING_REQUESTS: usize = 1024;

/// Why the store did not take a request. Trying again is safe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DeskError {
    /// It has too much to do, or an error that may pass.
    Busy,
    /// The disk is full or cannot be written.
    Disk,
}

impl From<&StudyError> for DeskError {
    fn from(error: &StudyError) -> Self {
        if error.is_of_disk() { Self::Disk } else { Self::Busy }
    }
}

/// Sends the reply to the request. The argument is whether the transaction is on disk.
type ReplyDelivery = Box<dyn FnOnce(Result<(), DeskError>) + Send>;
/// The database work of one request. It returns whether its changes are kept, and how its reply is sent.
type DeskJob = Box<dyn FnOnce(&StudyTransaction<'_>) -> (bool, ReplyDelivery) + Send>;

/// A message to the thread.
enum DeskTask {
    /// Do the work of a request.
    Ask(DeskJob),
    /// Empty the log after a deletion.
    Sweep,
}

/// Passes requests to the writing thread. Clones share one thread, which ends with the last of them.
#[derive(Clone)]
pub(crate) struct StudyDesk {
    jobs: mpsc::SyncSender<DeskTask>,
}

impl StudyDesk {
    /// Starts the thread.
    ///
    /// # Errors
    /// When the database cannot be opened, or the system has no thread.
    pub(crate) fn open(study: Arc<Study>) -> Result<(Self, JoinHandle<()>), StudyError> {
        let store = StudyStore::open(&study.database_file())?;
        Self::start(study, store)
    }

    /// Starts the thread with a store in memory, which ends with it.
    ///
    /// # Errors
    /// When the system has no thread or no memory.
    pub(crate) fn open_in_memory(study: Arc<Study>) -> Result<(Self, JoinHandle<()>), StudyError> {
        Self::start(study, StudyStore::open_in_memory()?)
    }

    fn start(study: Arc<Study>, mut store: StudyStore) -> Result<(Self, JoinHandle<()>), StudyError> {
        let (jobs, waiting) = mpsc::sync_channel::<DeskTask>(MAX_WAITING_REQUESTS);
        let thread = thread::Builder::new()
            .name("study-desk".to_owned())
            .spawn(move || {
                while let Ok(first) = waiting.recv() {
                    let (mut batch, mut is_sweep) = (Vec::new(), false);
                    for task in std::iter::once(first).chain(waiting.try_iter().take(MAX_BATCH_REQUESTS - 1)) {
                        match task {
                            DeskTask::Ask(job) => batch.push(job),
                            DeskTask::Sweep => is_sweep = true,
                        }
                    }
                    run_batch(&mut store, &study, batch);
                    if is_sweep {
                        store.empty_log();
                    }
                }
            })
            .map_err(StudyError::io_error("study-desk", "start the thread"))?;
        Ok((Self { jobs }, thread))
    }

    /// Empties the database's log after the pending writes, so that deleted data remain nowhere on the disk.
    pub(crate) fn request_sweep(&self) {
        // If the queue is full, the next sweep does it.
        let _ = self.jobs.try_send(DeskTask::Sweep);
    }

    /// Runs `work` in a transaction, and returns its result when that is on disk. After an error nothing was written.
    pub(crate) async fn ask_store<T: Send + 'static>(
        &self,
        work: impl FnOnce(&StudyTransaction<'_>) -> Result<T, StudyError> + Send + 'static,
    ) -> Result<T, DeskError> {
        let (reply, answer) = oneshot::channel();
        let job: DeskJob = Box::new(move |transaction| {
            let done = work(transaction);
            let is_good = done.is_ok();
            let deliver: ReplyDelivery = Box::new(move |kept: Result<(), DeskError>| {
                // The request may have been given up, and then needs no reply.
                let _ = reply.send(done.map_err(|error| DeskError::from(&error)).and_then(|done| kept.map(|()| done)));
            });
            (is_good, deliver)
        });
        self.jobs.try_send(DeskTask::Ask(job)).map_err(|_| DeskError::Busy)?;
        answer.await.unwrap_or(Err(DeskError::Busy))
    }
}

/// Does the work of all jobs in one transaction, and sends the replies when it is on disk.
fn run_batch(store: &mut StudyStore, study: &Study, batch: Vec<DeskJob>) {
    let mut replies: Vec<ReplyDelivery> = Vec::new();
    let committed = store.write_batch(study, batch.into_iter(), |job, transaction| {
        let (is_good, deliver) = job(transaction);
        replies.push(deliver);
        is_good
    });
    let kept = committed.map_err(|error| DeskError::from(&error));
    for deliver in replies {
        deliver(kept);
    }
}

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
/// Most requests in the queue. A further one fails with [`DeskBusyError`].
const MAX_WAITING_REQUESTS: usize = 1024;

/// The store cannot take the request now: trying again is safe.
#[derive(Debug)]
pub(crate) struct DeskBusyError;

/// Sends the reply to the request. The argument is true if the transaction is on disk.
type ReplyDelivery = Box<dyn FnOnce(bool) + Send>;
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
        let mut store = StudyStore::open(&study.database_file())?;
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
    ) -> Result<T, DeskBusyError> {
        let (reply, answer) = oneshot::channel();
        let job: DeskJob = Box::new(move |transaction| {
            let done = work(transaction);
            let is_good = done.is_ok();
            let deliver: ReplyDelivery = Box::new(move |is_kept| {
                // The request may have been given up, and then needs no reply.
                let _ = reply.send(done.ok().filter(|_| is_kept));
            });
            (is_good, deliver)
        });
        self.jobs.try_send(DeskTask::Ask(job)).map_err(|_| DeskBusyError)?;
        answer.await.ok().flatten().ok_or(DeskBusyError)
    }
}

/// Does the work of all jobs in one transaction, and sends the replies when it is on disk.
fn run_batch(store: &mut StudyStore, study: &Study, batch: Vec<DeskJob>) {
    let mut replies: Vec<(bool, ReplyDelivery)> = Vec::new();
    let committed = store.write_batch(study, batch.into_iter(), |job, transaction| {
        let (is_good, deliver) = job(transaction);
        replies.push((is_good, deliver));
        is_good
    });
    for (is_good, deliver) in replies {
        deliver(committed.is_ok() && is_good);
    }
}

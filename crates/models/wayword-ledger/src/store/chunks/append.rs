//! The one thread that writes a chunk's file. Each write has to wait for the disk, so the thread combines all lines that arrived during
//! the last write into the next one. It reports a line as written once the disk has it.

use super::line::{CHUNK_LINE_FORMAT, ChunkEntry};
use crate::{LedgerError, LedgerLocation, recording::MOST_LINE_BYTES};
use std::{
    fs::{File, OpenOptions},
    io::{self, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
    sync::mpsc,
    thread::{self, JoinHandle},
};

/// Most lines in the queue, and in one write. A sender waits while the queue is full, so that memory is bounded.
const MOST_AT_ONCE: usize = 1024;

type AppendResult = Result<(), LedgerError>;

struct AppendJob {
    line: Vec<u8>,
    /// Gets the result once the line is on disk, if a thread waits for it.
    done: Option<mpsc::SyncSender<AppendResult>>,
}

/// Passes lines to the writing thread. When it is dropped, all pending lines are written first.
#[derive(Debug)]
pub(super) struct ChunkAppender {
    jobs: Option<mpsc::SyncSender<AppendJob>>,
    thread: Option<JoinHandle<()>>,
    path: PathBuf,
}

impl ChunkAppender {
    /// Goes on with a file of which the first `sound` bytes are intact. The rest is cut off.
    pub(super) fn start(path: &Path, sound: u64) -> Result<Self, LedgerError> {
        let failed = LedgerError::io_error(path, "write the recording");
        let mut options = OpenOptions::new();
        options.create(true).truncate(false).write(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        let file = options.open(path).map_err(&failed)?;
        let mut tail = ChunkFileTail { file, sound, is_torn: true };
        if sound == 0 {
            let first =
                ChunkEntry::Ledger { format: CHUNK_LINE_FORMAT }.to_line().map_err(|error| failed(error.into()))?;
            tail.append_bytes(&first).map_err(&failed)?;
            keep_name(path);
        } else {
            tail.cut_torn_end().map_err(&failed)?;
        }
        let (sender, jobs) = mpsc::sync_channel(MOST_AT_ONCE);
        let place = LedgerLocation::from_path(path);
        let thread = thread::Builder::new()
            .name("recording".to_owned())
            .spawn(move || run_append_thread(&mut tail, &jobs, &place))
            .map_err(LedgerError::io_error(path, "start the ledger's thread"))?;
        Ok(Self { jobs: Some(sender), thread: Some(thread), path: path.to_owned() })
    }

    /// Writes a line, and returns once it is on disk.
    pub(super) fn write_line(&self, entry: &ChunkEntry) -> AppendResult {
        let (done, written) = mpsc::sync_channel(1);
        self.send_job(AppendJob { line: self.encode_line(entry)?, done: Some(done) });
        written.recv().unwrap_or_else(|_| Err(self.thread_ended_error()))
    }

    /// Writes a line with the next write that succeeds, and does not wait for it.
    pub(super) fn queue_line(&self, entry: &ChunkEntry) {
        if let Ok(line) = self.encode_line(entry) {
            self.send_job(AppendJob { line, done: None });
        }
    }

    /// Returns once all earlier lines are on disk.
    pub(super) fn flush(&self) -> AppendResult {
        let (done, written) = mpsc::sync_channel(1);
        self.send_job(AppendJob { line: Vec::new(), done: Some(done) });
        written.recv().unwrap_or_else(|_| Err(self.thread_ended_error()))
    }

    fn encode_line(&self, entry: &ChunkEntry) -> Result<Vec<u8>, LedgerError> {
        let failed = LedgerError::io_error(&self.path, "write the recording");
        let line = entry.to_line().map_err(|error| failed(error.into()))?;
        if line.len() as u64 > MOST_LINE_BYTES {
            return Err(failed(io::Error::new(io::ErrorKind::InvalidData, "a call is too long to be kept")));
        }
        Ok(line)
    }

    fn send_job(&self, job: AppendJob) {
        if let Some(jobs) = &self.jobs {
            // If the thread has ended, the caller that waits gets an error.
            let _ = jobs.send(job);
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

impl Drop for ChunkAppender {
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// A file, and how many of its bytes are intact.
struct ChunkFileTail {
    file: File,
    sound: u64,
    /// Whether the file may have other bytes behind the intact lines.
    is_torn: bool,
}

impl ChunkFileTail {
    /// Cuts off the bytes that a crash or a failed write has left behind the intact lines.
    fn cut_torn_end(&mut self) -> io::Result<()> {
        if self.is_torn {
            self.file.set_len(self.sound)?;
            self.file.seek(SeekFrom::Start(self.sound))?;
            self.is_torn = false;
        }
        Ok(())
    }

    /// Appends bytes, and returns once they are on disk.
    fn append_bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.cut_torn_end()?;
        let written = self.file.write_all(bytes).and_then(|()| self.file.sync_data());
        self.is_torn = written.is_err();
        self.sound += if written.is_ok() { bytes.len() as u64 } else { 0 };
        written
    }
}

fn run_append_thread(tail: &mut ChunkFileTail, jobs: &mpsc::Receiver<AppendJob>, place: &LedgerLocation) {
    let mut group = Vec::new();
    while let Ok(first) = jobs.recv() {
        group.push(first);
        while group.len() < MOST_AT_ONCE {
            let Ok(next) = jobs.try_recv() else { break };
            group.push(next);
        }
        let written = write_group(tail, &group, place);
        group = report_results(group, &written);
    }
    let _ = write_group(tail, &group, place);
}

fn write_group(tail: &mut ChunkFileTail, group: &[AppendJob], place: &LedgerLocation) -> AppendResult {
    let bytes: Vec<u8> = group.iter().flat_map(|job| &job.line).copied().collect();
    if bytes.is_empty() {
        return Ok(());
    }
    tail.append_bytes(&bytes).map_err(LedgerError::io_error(place.clone(), "write the recording"))
}

/// Passes the result to the threads that wait. Returns the lines that were not written and that no thread waits for:
/// they go into the next write.
fn report_results(group: Vec<AppendJob>, written: &AppendResult) -> Vec<AppendJob> {
    let mut unwritten = Vec::new();
    for job in group {
        match job.done {
            // The thread may no longer wait.
            Some(done) => drop(done.send(written.clone())),
            None if written.is_err() => unwritten.push(job),
            None => {}
        }
    }
    unwritten
}

/// Makes the name of a new file survive a loss of power, by syncing its folder. File systems that do not support this do not need it.
fn keep_name(path: &Path) {
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}

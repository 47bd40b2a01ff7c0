//! The one thread that writes a chunk's file. Each write has to wait for the disk, so the thread combines all lines that arrived during
//! the last write into the next one. It reports a line as written once the disk has it.

use super::line::{Entry, FORMAT};
use crate::{LedgerError, Place, recording::MOST_LINE_BYTES};
use std::{
    fs::{File, OpenOptions},
    io::{self, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
    sync::mpsc,
    thread::{self, JoinHandle},
};

/// Most lines in the queue, and in one write. A sender waits while the queue is full, so that memory is bounded.
const MOST_AT_ONCE: usize = 1024;

type Written = Result<(), LedgerError>;

struct Job {
    line: Vec<u8>,
    /// Gets the result once the line is on disk, if a thread waits for it.
    done: Option<mpsc::SyncSender<Written>>,
}

/// Passes lines to the writing thread. When it is dropped, all pending lines are written first.
#[derive(Debug)]
pub(super) struct Appender {
    jobs: Option<mpsc::SyncSender<Job>>,
    thread: Option<JoinHandle<()>>,
    path: PathBuf,
}

impl Appender {
    /// Goes on with a file of which the first `sound` bytes are intact. The rest is cut off.
    pub(super) fn start(path: &Path, sound: u64) -> Result<Self, LedgerError> {
        let failed = LedgerError::io(path, "write the recording");
        let mut options = OpenOptions::new();
        options.create(true).truncate(false).write(true);
        #[cfg(unix)]
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
        let file = options.open(path).map_err(&failed)?;
        let mut tail = Tail { file, sound, is_torn: true };
        if sound == 0 {
            let first = Entry::Ledger { format: FORMAT }.to_line().map_err(|error| failed(error.into()))?;
            tail.append(&first).map_err(&failed)?;
            keep_name(path);
        } else {
            tail.cut().map_err(&failed)?;
        }
        let (sender, jobs) = mpsc::sync_channel(MOST_AT_ONCE);
        let place = Place::file(path);
        let thread = thread::Builder::new()
            .name("recording".to_owned())
            .spawn(move || work(&mut tail, &jobs, &place))
            .map_err(LedgerError::io(path, "start the ledger's thread"))?;
        Ok(Self { jobs: Some(sender), thread: Some(thread), path: path.to_owned() })
    }

    /// Writes a line, and returns once it is on disk.
    pub(super) fn keep(&self, entry: &Entry) -> Written {
        let (done, written) = mpsc::sync_channel(1);
        self.send(Job { line: self.line(entry)?, done: Some(done) });
        written.recv().unwrap_or_else(|_| Err(self.gone()))
    }

    /// Writes a line with the next write that succeeds, and does not wait for it.
    pub(super) fn note(&self, entry: &Entry) {
        if let Ok(line) = self.line(entry) {
            self.send(Job { line, done: None });
        }
    }

    /// Returns once all earlier lines are on disk.
    pub(super) fn flush(&self) -> Written {
        let (done, written) = mpsc::sync_channel(1);
        self.send(Job { line: Vec::new(), done: Some(done) });
        written.recv().unwrap_or_else(|_| Err(self.gone()))
    }

    fn line(&self, entry: &Entry) -> Result<Vec<u8>, LedgerError> {
        let failed = LedgerError::io(&self.path, "write the recording");
        let line = entry.to_line().map_err(|error| failed(error.into()))?;
        if line.len() as u64 > MOST_LINE_BYTES {
            return Err(failed(io::Error::new(io::ErrorKind::InvalidData, "a call is too long to be kept")));
        }
        Ok(line)
    }

    fn send(&self, job: Job) {
        if let Some(jobs) = &self.jobs {
            // If the thread has ended, the caller that waits gets an error.
            let _ = jobs.send(job);
        }
    }

    fn gone(&self) -> LedgerError {
        LedgerError::Store {
            place: Place::file(&self.path),
            doing: "write",
            reason: "the thread that writes it has ended".to_owned(),
            hint: "run the same command again",
            is_lost: false,
        }
    }
}

impl Drop for Appender {
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// A file, and how many of its bytes are intact.
struct Tail {
    file: File,
    sound: u64,
    /// Whether the file may have other bytes behind the intact lines.
    is_torn: bool,
}

impl Tail {
    /// Cuts off the bytes that a crash or a failed write has left behind the intact lines.
    fn cut(&mut self) -> io::Result<()> {
        if self.is_torn {
            self.file.set_len(self.sound)?;
            self.file.seek(SeekFrom::Start(self.sound))?;
            self.is_torn = false;
        }
        Ok(())
    }

    /// Appends bytes, and returns once they are on disk.
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.cut()?;
        let written = self.file.write_all(bytes).and_then(|()| self.file.sync_data());
        self.is_torn = written.is_err();
        self.sound += if written.is_ok() { bytes.len() as u64 } else { 0 };
        written
    }
}

fn work(tail: &mut Tail, jobs: &mpsc::Receiver<Job>, place: &Place) {
    let mut group = Vec::new();
    while let Ok(first) = jobs.recv() {
        group.push(first);
        while group.len() < MOST_AT_ONCE {
            let Ok(next) = jobs.try_recv() else { break };
            group.push(next);
        }
        let written = write(tail, &group, place);
        group = tell(group, &written);
    }
    let _ = write(tail, &group, place);
}

fn write(tail: &mut Tail, group: &[Job], place: &Place) -> Written {
    let bytes: Vec<u8> = group.iter().flat_map(|job| &job.line).copied().collect();
    if bytes.is_empty() {
        return Ok(());
    }
    tail.append(&bytes).map_err(LedgerError::io(place.clone(), "write the recording"))
}

/// Passes the result to the threads that wait. Returns the lines that were not written and that no thread waits for:
/// they go into the next write.
fn tell(group: Vec<Job>, written: &Written) -> Vec<Job> {
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

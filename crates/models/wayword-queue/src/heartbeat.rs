//! Heartbeats of workers that share only a folder.
//!
//! A worker has a file in the folder and writes it anew every few seconds. The age of the file is measured by the clock of
//! the file system, because the machines' own clocks may differ. A worker that finds a fresh file of another worker with
//! the same part is refused, so that no two workers make the same chunks.

use crate::{
    QueueError,
    folder::remove_if_there,
    marks::{from_file, to_bytes},
    process_identity::ProcessIdentity,
    put_new, put_whole,
};
use serde::{Deserialize, Serialize};
use std::{
    fs,
    io::ErrorKind,
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc,
    },
    thread::{self, JoinHandle},
    time::{Duration, SystemTime},
};

/// How long a heartbeat counts. A worker without a newer one is taken for dead.
pub const HEARTBEAT_LEASE: Duration = Duration::from_secs(60);
/// How many heartbeats a worker gives in the time for which one counts.
const BEATS_PER_LEASE: u32 = 6;

/// The folder of the heartbeat files, in a run folder.
pub const WORKERS_FOLDER: &str = "workers";

/// The content of a heartbeat file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct WorkerHeartbeat {
    /// The worker, for people: machine and process.
    pub worker: String,
    /// A token that no other worker has.
    pub token: String,
    /// Its part of the run, as in `shard 3 of 64`.
    pub part: String,
    /// Its process; `None` in files of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub process: Option<ProcessIdentity>,
}

impl WorkerHeartbeat {
    /// The heartbeat of this process.
    #[must_use]
    pub fn of_this_process(worker: &str, part: String) -> Self {
        let process = Some(ProcessIdentity::this_process());
        Self { worker: worker.to_owned(), token: worker.to_owned(), part, process }
    }

    /// The heartbeat of a file that cannot be read: some worker may have it.
    fn unreadable() -> Self {
        Self {
            worker: "a worker whose file cannot be read".into(),
            token: String::new(),
            part: "?".into(),
            process: None,
        }
    }
}

/// A heartbeat file of a run folder, with its age.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HeartbeatEntry {
    /// The name of its file.
    pub file: String,
    /// Its content.
    pub beat: WorkerHeartbeat,
    /// Time since it was written, by the clock of the file system.
    pub age: Duration,
}

impl HeartbeatEntry {
    /// Whether its worker may be at work: it was written less than `fresh` ago, and its process is not known to have ended.
    #[must_use]
    pub fn may_live(&self, fresh: Duration) -> bool {
        self.age < fresh && !self.beat.process.as_ref().is_some_and(ProcessIdentity::has_ended)
    }
}

/// A name for this worker that no other has: machine, process, a word for the place in which its number counts, and time.
#[must_use]
pub fn worker_name() -> String {
    // If the machine has no name, process and time still distinguish workers.
    let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let host: String = host.trim().chars().filter(|c| c.is_ascii_alphanumeric() || *c == '-').take(40).collect();
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default().as_micros();
    format!("{host}-{}-{}-{since:x}", std::process::id(), ProcessIdentity::this_process().place_word())
}

/// Whether it is known that the process of a worker of this name has ended: it was one of this machine, and no process here has its
/// number. Where another process took over the number, this is not known.
#[cfg(any(feature = "postgres", test))]
pub(crate) fn named_worker_has_ended(name: &str) -> bool {
    let this = ProcessIdentity::this_process();
    let mut parts = name.rsplit('-');
    let (Some(_), Some(place), Some(pid)) = (parts.next(), parts.next(), parts.next()) else { return false };
    let Ok(pid) = pid.parse() else { return false };
    !this.place.is_empty() && place == this.place_word() && crate::process_identity::process_start(pid).is_none()
}

/// A thread that renews a worker's heartbeat file until it is dropped.
#[derive(Debug)]
pub struct HeartbeatThread {
    /// The heartbeat file, and the token in it that shows that it is this worker's.
    path: PathBuf,
    token: String,
    /// Whether another worker took over the file.
    is_lost: Arc<AtomicBool>,
    /// Ends the thread when it is dropped.
    end: Option<mpsc::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl HeartbeatThread {
    /// Starts a heartbeat in the file `name`. A heartbeat counts for the time `fresh`.
    ///
    /// # Errors
    /// When another worker has a fresh heartbeat in a file of this name, or in a file for which `excludes` returns true.
    pub fn start(
        folder: &Path,
        name: &str,
        beat: WorkerHeartbeat,
        fresh: Duration,
        excludes: impl Fn(&str) -> bool,
    ) -> Result<Self, QueueError> {
        let workers = folder.join(WORKERS_FOLDER);
        fs::create_dir_all(&workers).map_err(QueueError::for_file(&workers, "make the folder"))?;
        let path = workers.join(name);
        for entry in read_heartbeats(folder)? {
            let may_live = entry.may_live(fresh);
            let HeartbeatEntry { file, beat: other, age } = entry;
            if may_live && other.token != beat.token && (file == name || excludes(&file)) {
                return Err(QueueError::Busy {
                    path: workers.join(file),
                    who: format!("{} ({})", other.worker, other.part),
                    seconds: age.as_secs(),
                    fresh: fresh.as_secs(),
                });
            }
        }
        // The file of a dead worker is removed. If several workers do this at the same moment, one of them writes first.
        remove_if_there(&path)?;
        let bytes = to_bytes(&path, &beat)?;
        if !put_new(&path, &bytes)? {
            let who =
                from_file::<WorkerHeartbeat>(&path)?.map_or_else(|| "another worker".to_owned(), |other| other.worker);
            return Err(QueueError::Busy { path, who, seconds: 0, fresh: fresh.as_secs() });
        }
        let (end, ended) = mpsc::channel();
        let is_lost = Arc::new(AtomicBool::new(false));
        let thread = {
            let (path, is_lost, token) = (path.clone(), Arc::clone(&is_lost), beat.token.clone());
            let every = fresh / BEATS_PER_LEASE;
            thread::Builder::new().name("heartbeat".to_owned()).spawn(move || {
                while ended.recv_timeout(every) == Err(mpsc::RecvTimeoutError::Timeout) {
                    if !has_token(&path, &token) {
                        is_lost.store(true, Ordering::SeqCst);
                        return;
                    }
                    // If this write fails, the next one may succeed.
                    let _ = put_whole(&path, &bytes);
                }
            })
        };
        let thread = thread.map_err(QueueError::for_file(&path, "start the thread that writes"))?;
        Ok(Self { path, token: beat.token, is_lost, end: Some(end), thread: Some(thread) })
    }

    /// Refuses to go on if another worker took over, because this one was suspended for too long.
    ///
    /// # Errors
    /// [`QueueError::TakenOver`].
    pub fn check_heartbeat(&self) -> Result<(), QueueError> {
        if self.is_lost.load(Ordering::SeqCst) || !has_token(&self.path, &self.token) {
            return Err(QueueError::TakenOver(self.path.clone()));
        }
        Ok(())
    }
}

impl Drop for HeartbeatThread {
    fn drop(&mut self) {
        self.end = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
        if has_token(&self.path, &self.token) {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Whether a file is still this worker's. A file that cannot be read for a moment counts as this worker's.
fn has_token(path: &Path, token: &str) -> bool {
    match from_file::<WorkerHeartbeat>(path) {
        Ok(Some(beat)) => beat.token == token,
        Ok(None) => false,
        Err(_) => true,
    }
}

/// The heartbeats in a run folder, by the names of their files, with their ages by the clock of the file system.
///
/// # Errors
/// When the folder cannot be read.
pub fn read_heartbeats(folder: &Path) -> Result<Vec<HeartbeatEntry>, QueueError> {
    let workers = folder.join(WORKERS_FOLDER);
    let entries = match fs::read_dir(&workers) {
        Ok(entries) => entries,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(source) => return Err(QueueError::Io { path: workers, doing: "list", source }),
    };
    let now = file_system_time(&workers)?;
    let mut beats = Vec::new();
    for entry in entries.flatten() {
        let Ok(name) = entry.file_name().into_string() else { continue };
        // A file that is being written has a longer name.
        if name.contains('.') {
            continue;
        }
        let beat = match from_file::<WorkerHeartbeat>(&entry.path()) {
            Ok(Some(beat)) => beat,
            // It was removed meanwhile.
            Ok(None) => continue,
            Err(_) => WorkerHeartbeat::unreadable(),
        };
        let Ok(about) = entry.metadata() else { continue };
        let age = about.modified().ok().and_then(|at| now.duration_since(at).ok()).unwrap_or_default();
        beats.push(HeartbeatEntry { file: name, beat, age });
    }
    beats.sort_by(|a, b| a.file.cmp(&b.file));
    Ok(beats)
}

/// The time by the clock of the file system: that of a file written just now.
fn file_system_time(folder: &Path) -> Result<SystemTime, QueueError> {
    let path = folder.join(format!(".clock-{}-{:?}", std::process::id(), thread::current().id()));
    let failed = || QueueError::for_file(&path, "ask the file system for the time by");
    put_whole(&path, b"now")?;
    let now = fs::metadata(&path).and_then(|about| about.modified()).map_err(failed())?;
    fs::remove_file(&path).map_err(failed())?;
    Ok(now)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn beat(token: &str) -> WorkerHeartbeat {
        WorkerHeartbeat {
            worker: format!("host {token}"),
            token: token.to_owned(),
            part: "shard 0 of 2".to_owned(),
            process: None,
        }
    }

    #[test]
    fn start_refuses_a_second_worker_while_the_first_lives() {
        let folder = tempfile::tempdir().unwrap();
        let start = |token: &str, fresh| HeartbeatThread::start(folder.path(), "shard", beat(token), fresh, |_| false);
        let first = start("a", HEARTBEAT_LEASE).unwrap();
        let refused = start("b", HEARTBEAT_LEASE).unwrap_err();
        assert!(matches!(refused, QueueError::Busy { .. }) && refused.to_string().contains("host a"), "{refused}");
        drop(first);
        assert!(start("b", HEARTBEAT_LEASE).is_ok());
    }

    #[test]
    fn check_fails_after_a_suspended_worker_was_taken_over() {
        let folder = tempfile::tempdir().unwrap();
        // The first beats too seldom for the second's patience, as a suspended one does.
        let first = HeartbeatThread::start(folder.path(), "shard", beat("a"), HEARTBEAT_LEASE, |_| false).unwrap();
        thread::sleep(Duration::from_millis(60));
        let second =
            HeartbeatThread::start(folder.path(), "shard", beat("b"), Duration::from_millis(50), |_| false).unwrap();
        assert!(matches!(first.check_heartbeat(), Err(QueueError::TakenOver(_))));
        drop(first);
        assert!(second.check_heartbeat().is_ok(), "the first does not remove the second's file");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_worker_of_this_machine_that_has_ended_frees_its_part_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let start = |beat| HeartbeatThread::start(folder.path(), "shard", beat, HEARTBEAT_LEASE, |_| false);
        let workers = folder.path().join(WORKERS_FOLDER);
        fs::create_dir_all(&workers).unwrap();
        let this = ProcessIdentity::this_process();
        let left_behind = |process: &ProcessIdentity| {
            let beat = WorkerHeartbeat { process: Some(process.clone()), ..beat("old") };
            fs::write(workers.join("shard"), to_bytes(Path::new(""), &beat).unwrap()).unwrap();
        };
        for lives in
            [this.clone(), ProcessIdentity { place: "another machine".into(), began: "0".into(), ..this.clone() }]
        {
            left_behind(&lives);
            assert!(matches!(start(beat("new")), Err(QueueError::Busy { .. })), "{lives:?}");
        }
        // This process has its number since another time.
        left_behind(&ProcessIdentity { began: "0".into(), ..this });
        assert!(!read_heartbeats(folder.path()).unwrap()[0].may_live(HEARTBEAT_LEASE));
        assert!(start(beat("new")).is_ok());
    }

    #[test]
    fn a_heartbeat_that_cannot_be_read_counts_as_some_worker() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join(WORKERS_FOLDER)).unwrap();
        fs::write(folder.path().join(WORKERS_FOLDER).join("shard"), "{\"worker\":").unwrap();
        let refused =
            HeartbeatThread::start(folder.path(), "shard", beat("a"), HEARTBEAT_LEASE, |_| false).unwrap_err();
        assert!(refused.to_string().contains("cannot be read"), "{refused}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_name_of_a_worker_tells_whether_it_has_ended() {
        assert!(!named_worker_has_ended(&worker_name()));
        let place = ProcessIdentity::this_process().place_word();
        let beyond_every_number = u32::MAX;
        assert!(named_worker_has_ended(&format!("my-host-{beyond_every_number}-{place}-1f")));
        for unknown in ["w", "", "a-b-c-d", &format!("host-{beyond_every_number}-00000000-1f"), "host-12-1f"] {
            assert!(!named_worker_has_ended(unknown), "{unknown}");
        }
    }
}

//! `wayword runs status`: how far a run of many workers is.

use super::{damage::damage_lines, unfinished::items_in_unfinished};
use crate::runs::args::{RunsQueue, RunsStatus};
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
    path::Path,
    thread,
    time::{Duration, SystemTime, UNIX_EPOCH},
};
use wayword_queue::{
    ChunkPlan, ChunkRecord, CompareDepth, HEARTBEAT_LEASE, HeartbeatEntry, read_dead_mark, read_heartbeats,
};
use wayword_run::{
    count::count_phrase,
    error::{CommandError, Exit},
    generate::{ChunkChecker, ChunkDamage, ChunkHandout},
    interrupt,
    stores::RunPlace,
};

/// How often the status is shown again.
const STATUS_INTERVAL: Duration = Duration::from_secs(5);
/// The pace is measured over the chunks that were finished within this many seconds before now.
const PACE_WINDOW_S: u64 = 600;
/// Most slow chunks, and most reasons of each kind, that are shown.
const MAX_SHOWN_ENTRIES: usize = 5;

/// The queue of a build without one.
#[cfg(not(feature = "queue"))]
pub(super) enum NoQueue {}

/// The queue of a run; `None` if its workers have fixed parts, or none has begun.
#[cfg(feature = "queue")]
pub(super) fn queue_of(
    place: &RunPlace,
    plan: &ChunkPlan,
    asked: &RunsQueue,
) -> Result<Option<wayword_queue::ChunkQueue>, CommandError> {
    let Some(ChunkHandout::Queue(name)) = ChunkHandout::from_folder(place.folder())? else { return Ok(None) };
    // The file in a store could be forged, and must not choose which server gets the user's password.
    if place.is_stored() && asked.queue.as_ref() != Some(&name) {
        return Err(CommandError::usage(
            format!("{}: its workers use the queue {name}", place.shown_path().display()),
            format!("if you know it, give --queue {name}"),
        ));
    }
    let database = wayword_database::PostgresDatabase::from_name(&name, asked.password_env.as_deref())?;
    Ok(Some(wayword_queue::ChunkQueue::open(database, place.folder(), plan)?))
}

/// As `queue_of` with databases, in a build without them: a run with a queue is an error.
#[cfg(not(feature = "queue"))]
pub(super) fn queue_of(place: &RunPlace, _: &ChunkPlan, _: &RunsQueue) -> Result<Option<NoQueue>, CommandError> {
    match ChunkHandout::from_folder(place.folder())? {
        Some(ChunkHandout::Queue(name)) => Err(CommandError::not_built(format!(
            "the queue {name} cannot be used: this build has no way to a database"
        ))),
        _ => Ok(None),
    }
}

/// How far a run is.
#[derive(Debug, Default, Serialize)]
pub(super) struct RunStatus {
    pub(super) run: String,
    pub(super) items: usize,
    /// Items of finished chunks.
    pub(super) items_done: usize,
    /// Items that are made in chunks which are not finished.
    pub(super) items_kept: usize,
    pub(super) chunks: usize,
    pub(super) done: usize,
    pub(super) running: usize,
    pub(super) open: usize,
    /// Chunks that were given up, with the reason.
    pub(super) dead: BTreeMap<usize, String>,
    /// Files of finished chunks that do not fit their marks.
    pub(super) damaged: Vec<ChunkDamage>,
    /// Finished chunks whose marks hold no hashes, because an older version finished them.
    pub(super) without_hashes: usize,
    pub(super) written: usize,
    pub(super) rejected: usize,
    /// Items that failed, by reason.
    pub(super) failed: BTreeMap<String, usize>,
    /// How often chunks were begun again, by reason.
    pub(super) retries: BTreeMap<String, i64>,
    /// The cost of the calls of finished chunks, US dollars.
    pub(super) usd: f64,
    pub(super) items_per_minute: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) minutes_left: Option<f64>,
    /// The chunks that took longest, in seconds.
    pub(super) slowest: Vec<(usize, f64)>,
    pub(super) workers: Vec<WorkerAtWork>,
}

/// A worker.
#[derive(Debug, Serialize)]
pub(super) struct WorkerAtWork {
    pub(super) worker: String,
    /// Its part, or the chunk that it has.
    pub(super) has: String,
    /// Seconds since its last sign of life.
    pub(super) beat_s: f64,
    /// Whether that is recent enough to count.
    pub(super) is_fresh: bool,
}

/// Runs `wayword runs status`: gives the status of the run to `show`, once or again and again.
pub(super) fn run_status(args: &RunsStatus, show: impl Fn(&RunStatus)) -> Result<Exit, CommandError> {
    let place = RunPlace::open_named(&args.run)?;
    let (folder, plan) = (place.folder(), ChunkPlan::for_folder(place.folder())?);
    let queue = queue_of(&place, &plan, &args.database)?;
    let depth = match (place.is_stored(), args.prometheus) {
        // The results lie in the store.
        (true, _) => CompareDepth::Marks,
        // It is asked for again and again.
        (false, true) => CompareDepth::Lengths,
        (false, false) => CompareDepth::Files,
    };
    let mut checker = ChunkChecker::new(folder, &plan, depth);
    loop {
        place.fetch_marks(&plan)?;
        let mut status =
            RunStatus { run: args.run.display().to_string(), ..RunStatus::from_folder(folder, &plan, &mut checker)? };
        #[cfg(feature = "queue")]
        if let Some(queue) = &queue {
            status.use_queue_status(queue.read_status()?);
        }
        #[cfg(not(feature = "queue"))]
        let _ = &queue;
        status.workers.sort_by(|a, b| a.worker.cmp(&b.worker));
        show(&status);
        if !args.watch || status.open + status.running == 0 {
            return Ok(Exit::Done);
        }
        thread::sleep(STATUS_INTERVAL);
        interrupt::check_interrupt()?;
    }
}

impl RunStatus {
    /// The status according to the files in the folder.
    fn from_folder(folder: &Path, plan: &ChunkPlan, checker: &mut ChunkChecker<'_>) -> Result<Self, CommandError> {
        let mut status = Self { items: plan.items.len(), chunks: plan.chunk_count(), ..Self::default() };
        let checked = checker.check_chunks(|| ())?;
        let mut done = checked.done;
        (status.damaged, status.without_hashes) = (checked.damaged, checked.without_hashes.len());
        for record in &done {
            status.items_done += plan.chunk_range(record.chunk).len();
            status.count_done(record);
        }
        let finished: BTreeSet<usize> = done.iter().map(|record| record.chunk).collect();
        status.items_kept = items_in_unfinished(folder, &finished)?;
        for chunk in (0..plan.chunk_count()).filter(|chunk| !finished.contains(chunk)) {
            if let Some(reason) = read_dead_mark(folder, chunk)? {
                status.dead.insert(chunk, reason);
            }
        }
        status.done = done.len();
        status.workers = read_heartbeats(folder)?.into_iter().map(WorkerAtWork::from).collect();
        status.running = status.workers.iter().filter(|worker| worker.is_fresh).count();
        status.running = status.running.min(status.chunks - status.done - status.dead.len());
        status.open = status.chunks - status.done - status.running - status.dead.len();
        status.fill_pace(plan, &done);
        done.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        status.slowest = done.iter().take(MAX_SHOWN_ENTRIES).map(|record| (record.chunk, record.seconds)).collect();
        Ok(status)
    }

    fn count_done(&mut self, done: &ChunkRecord) {
        self.written += done.written;
        self.rejected += done.rejected;
        self.usd += done.usd;
        for (reason, times) in &done.failed {
            *self.failed.entry(reason.clone()).or_default() += times;
        }
    }

    /// Fills in the items a minute over the last ten minutes, and how long the rest takes at that pace.
    fn fill_pace(&mut self, plan: &ChunkPlan, done: &[ChunkRecord]) {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
        let recent: Vec<&ChunkRecord> = done.iter().filter(|record| record.at_unix_s + PACE_WINDOW_S >= now).collect();
        let begun = |record: &&ChunkRecord| record.at_unix_s.saturating_sub(record.seconds as u64);
        let Some(first) = recent.iter().map(begun).min() else { return };
        let minutes = now.saturating_sub(first.max(now.saturating_sub(PACE_WINDOW_S))).max(1) as f64 / 60.0;
        let items: usize = recent.iter().map(|record| plan.chunk_range(record.chunk).len()).sum();
        self.items_per_minute = items as f64 / minutes;
        let dead: usize = self.dead.keys().map(|chunk| plan.chunk_range(*chunk).len()).sum();
        let left = self.items.saturating_sub(self.items_done + dead);
        self.minutes_left = (left > 0 && self.items_per_minute > 0.0).then(|| left as f64 / self.items_per_minute);
    }

    /// Replaces the counts of chunks by those of the queue's database, which are more exact, and adds its workers.
    #[cfg(feature = "queue")]
    fn use_queue_status(&mut self, queue: wayword_queue::QueueStatus) {
        (self.open, self.running, self.done) = (queue.open, queue.running, queue.done);
        self.dead = queue.dead.into_iter().collect();
        self.retries = queue.retries.into_iter().collect();
        self.workers.extend(queue.workers.into_iter().map(|worker| WorkerAtWork {
            has: worker.chunk.map_or_else(
                || "no chunk".to_owned(),
                |chunk| format!("chunk {chunk} for {:.0} s", worker.chunk_s.unwrap_or_default()),
            ),
            worker: worker.worker,
            beat_s: worker.beat_s,
            is_fresh: worker.beat_s < HEARTBEAT_LEASE.as_secs_f64(),
        }));
    }
}

impl From<HeartbeatEntry> for WorkerAtWork {
    fn from(entry: HeartbeatEntry) -> Self {
        let is_fresh = entry.may_live(HEARTBEAT_LEASE);
        let HeartbeatEntry { beat, age, .. } = entry;
        Self { worker: beat.worker, has: beat.part, beat_s: age.as_secs_f64(), is_fresh }
    }
}

impl fmt::Display for RunStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = 100.0 * self.items_done as f64 / self.items.max(1) as f64;
        writeln!(f, "{}: {} of {} ({share:.1} %)", self.run, self.items_done, count_phrase(self.items, "item"))?;
        if self.items_kept > 0 {
            writeln!(f, "begun    {} more in chunks that are not finished", count_phrase(self.items_kept, "item"))?;
        }
        writeln!(
            f,
            "chunks   {} done, {} running, {} open, {} given up",
            self.done,
            self.running,
            self.open,
            self.dead.len()
        )?;
        let failed: usize = self.failed.values().sum();
        writeln!(
            f,
            "texts    {} written, {} rejected; {} failed",
            self.written,
            self.rejected,
            count_phrase(failed, "item")
        )?;
        write!(f, "pace     {:.1} items a minute", self.items_per_minute)?;
        match self.minutes_left {
            Some(minutes) => writeln!(f, ", about {minutes:.0} minutes left")?,
            None => writeln!(f)?,
        }
        if self.usd > 0.0 {
            writeln!(f, "cost     ${:.4} for the finished chunks", self.usd)?;
        }
        for line in damage_lines(&self.damaged) {
            writeln!(f, "damaged  {line}")?;
        }
        if !self.damaged.is_empty() {
            writeln!(f, "         make these chunks again: wayword runs retry {} --damaged", self.run)?;
        }
        if self.without_hashes > 0 {
            writeln!(
                f,
                "older    {}: their marks hold no hashes, so only counts and names are compared",
                count_phrase(self.without_hashes, "finished chunk")
            )?;
        }
        for (reason, times) in self.failed.iter().take(MAX_SHOWN_ENTRIES) {
            writeln!(f, "failed   {times} x {reason}")?;
        }
        for (chunk, reason) in self.dead.iter().take(MAX_SHOWN_ENTRIES) {
            writeln!(f, "given up chunk {chunk}: {reason}")?;
        }
        for (reason, times) in self.retries.iter().take(MAX_SHOWN_ENTRIES) {
            writeln!(f, "retried  {times} x {reason}")?;
        }
        let slowest: Vec<String> =
            self.slowest.iter().map(|(chunk, seconds)| format!("{chunk} ({seconds:.0} s)")).collect();
        if !slowest.is_empty() {
            writeln!(f, "slowest  chunk {}", slowest.join(", "))?;
        }
        for worker in &self.workers {
            let life = if worker.is_fresh { "" } else { ", seems gone" };
            writeln!(
                f,
                "worker   {}: {}; last sign of life {:.0} s ago{life}",
                worker.worker, worker.has, worker.beat_s
            )?;
        }
        Ok(())
    }
}

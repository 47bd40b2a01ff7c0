//! Connects a worker to the board that hands out its chunks, and chooses the ledger for its calls: both are in the shared folder
//! (`--shard`), or in a database (`--queue`).

use crate::{
    calls::CallKeeping, error::CommandError, generate::workers::args::AskedWorkers, output::CommandOutput,
    settings::Service, stores::RunPlace,
};
use serde::{Deserialize, Serialize};
use std::path::Path;
use wayword_queue::{
    ChunkBoard, ChunkPlan, HeartbeatThread, ShardBoard, ShardPart, WORKERS_FILE, WorkerHeartbeat, chunk_folder, put_new,
};

/// How the chunks of a run are handed out. All workers of a run must use the same way; a file in its folder records which.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ChunkHandout {
    /// Each worker has a fixed part.
    Shards,
    /// A database hands out the open chunks. This is its name, without a password.
    Queue(String),
}

impl ChunkHandout {
    /// Reads how the chunks of a folder are handed out; `None` before its first worker.
    ///
    /// # Errors
    /// When its file cannot be read.
    pub fn from_folder(folder: &Path) -> Result<Option<Self>, CommandError> {
        let path = folder.join(WORKERS_FILE);
        if !path.exists() {
            return Ok(None);
        }
        let text = crate::text_file::read_text_file(&path, "read how chunks are handed out")?;
        serde_json::from_str(&text).map(Some).map_err(|error| {
            CommandError::usage(format!("{}: {error}", path.display()), "it was changed by hand: use another folder")
        })
    }

    /// Records this choice in the folder of the run, or refuses it if other workers use another one.
    fn record_in(&self, place: &RunPlace) -> Result<(), CommandError> {
        let (folder, path) = (place.folder(), place.folder().join(WORKERS_FILE));
        let text = serde_json::to_string(self).unwrap_or_default();
        put_new(&path, text.as_bytes())?;
        place.publish_file(WORKERS_FILE)?;
        match Self::from_folder(folder)? {
            Some(kept) if kept == *self => Ok(()),
            kept => Err(CommandError::usage(
                format!(
                    "{}: its workers take chunks by {}, not by {self}",
                    place.shown_path().display(),
                    kept.unwrap_or(Self::Shards)
                ),
                "give the same flag (--shard or --queue) and the same database to all workers, or another --out",
            )),
        }
    }
}

impl std::fmt::Display for ChunkHandout {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Shards => write!(f, "--shard"),
            Self::Queue(name) => write!(f, "--queue {name}"),
        }
    }
}

/// The board from which this worker takes its chunks.
pub(super) enum WorkerBoard<'a> {
    /// A fixed part of the chunks, with their state in the shared folder. `heart` writes this worker's signs of life.
    Shard { folder: &'a Path, plan: &'a ChunkPlan, part: ShardPart, heart: HeartbeatThread },
    /// A database that hands out chunks. `lease` is how long a sign of life counts.
    #[cfg(feature = "queue")]
    Queue { queue: wayword_queue::ChunkQueue, database: wayword_database::PostgresDatabase, lease: std::time::Duration },
}

impl<'a> WorkerBoard<'a> {
    /// Joins the workers of a run.
    pub(super) fn open(
        place: &'a RunPlace,
        plan: &'a ChunkPlan,
        worker: &str,
        asked: &AskedWorkers,
    ) -> Result<Self, CommandError> {
        match (asked.shard, &asked.queue) {
            (Some(part), _) => {
                let folder = place.folder();
                ChunkHandout::Shards.record_in(place)?;
                let beat = WorkerHeartbeat::of_this_process(worker, format!("shard {part}"));
                let heart =
                    HeartbeatThread::start(folder, &part.heartbeat_name(), beat, asked.lease_duration(), |file| {
                        part.overlaps_part(file)
                    })?;
                Ok(Self::Shard { folder, plan, part, heart })
            }
            (None, Some(name)) => Self::join_queue(place, plan, name, worker, asked),
            (None, None) => Err(CommandError::usage("this worker has no part", "give --shard or --queue")),
        }
    }

    #[cfg(feature = "queue")]
    fn join_queue(
        place: &RunPlace,
        plan: &ChunkPlan,
        name: &str,
        worker: &str,
        asked: &AskedWorkers,
    ) -> Result<Self, CommandError> {
        let database = wayword_database::PostgresDatabase::from_name(name, asked.password_env.as_deref())?;
        ChunkHandout::Queue(name.to_owned()).record_in(place)?;
        let queue = wayword_queue::ChunkQueue::open(database.clone(), place.folder(), plan)?
            .join_as(worker, asked.lease_duration())?;
        Ok(Self::Queue { queue, database, lease: asked.lease_duration() })
    }

    #[cfg(not(feature = "queue"))]
    fn join_queue(_: &RunPlace, _: &ChunkPlan, _: &str, _: &str, _: &AskedWorkers) -> Result<Self, CommandError> {
        Err(CommandError::not_built("--queue cannot be used: this build has no way to a database"))
    }

    /// How many workers of a queue are at work, this one included; `None` in a shard, whose number of parts is known beforehand.
    pub(super) fn worker_count(&self) -> Result<Option<usize>, CommandError> {
        match self {
            Self::Shard { .. } => Ok(None),
            #[cfg(feature = "queue")]
            Self::Queue { queue, lease, .. } => {
                let workers = queue.read_status()?.workers;
                Ok(Some(workers.iter().filter(|worker| worker.beat_s < lease.as_secs_f64()).count()))
            }
        }
    }

    /// The ledger for this worker's calls.
    pub(super) fn kept_calls(&self) -> CallKeeping {
        match self {
            Self::Shard { folder, plan, part, .. } => {
                let recordings = part.chunk_numbers(plan).map(|chunk| recording_path(&chunk_folder(folder, chunk, 0)));
                CallKeeping::Chunks(recordings.filter(|path| path.exists()).collect())
            }
            #[cfg(feature = "queue")]
            Self::Queue { database, lease, .. } => CallKeeping::Database(database.clone(), *lease),
        }
    }

    /// Runs `work` with the board.
    pub(super) fn with_board<T>(&self, work: impl FnOnce(&dyn ChunkBoard) -> T) -> T {
        match self {
            Self::Shard { folder, plan, part, heart } => work(&ShardBoard::new(folder, plan, *part, heart)),
            #[cfg(feature = "queue")]
            Self::Queue { queue, .. } => work(queue),
        }
    }

    /// Writes the marks that killed workers of a queue did not write.
    pub(super) fn write_missing_marks(&self) -> Result<(), CommandError> {
        match self {
            Self::Shard { .. } => Ok(()),
            #[cfg(feature = "queue")]
            Self::Queue { queue, .. } => Ok(queue.write_missing_marks().map(drop)?),
        }
    }
}

/// The recording of a chunk's calls.
pub(crate) fn recording_path(chunk: &Path) -> std::path::PathBuf {
    chunk.join("calls.jsonl")
}

/// The limits of one worker: a shard gets its part of the budget and the rates; a worker of a queue gets the whole, because the
/// database counts for all workers together.
pub(super) fn worker_service(
    service: &Service,
    asked: &AskedWorkers,
    output: &CommandOutput,
) -> Result<Service, CommandError> {
    if service.ledger.is_some() {
        return Err(CommandError::usage(
            "--ledger cannot be combined with --shard, --queue or --plan: a shard keeps the calls in its chunks, a queue in its database",
            "leave --ledger out",
        ));
    }
    let Some(part) = asked.shard else { return Ok(service.clone()) };
    let n = part.n as f64;
    let own = Service {
        max_usd: service.max_usd.map(|usd| usd / n),
        max_calls: service.max_calls.map(|calls| calls / part.n as u64),
        requests_per_minute: service.requests_per_minute.map(|rate| rate / n),
        tokens_per_minute: service.tokens_per_minute.map(|rate| rate / n),
        ..service.clone()
    };
    let limits = [
        own.max_usd.map(|usd| format!("${usd:.4} of --max-usd")),
        own.max_calls.map(|calls| format!("{calls} of --max-calls")),
        own.requests_per_minute.map(|rate| format!("{rate:.2} of --requests-per-minute")),
        own.tokens_per_minute.map(|rate| format!("{rate:.0} of --tokens-per-minute")),
    ];
    let limits: Vec<String> = limits.into_iter().flatten().collect();
    if !limits.is_empty() {
        output.say(format_args!("shard {part} may use a part of the whole run's: {}", limits.join(", ")));
    }
    Ok(own)
}

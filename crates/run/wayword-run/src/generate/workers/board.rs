//! Connects a worker to the board that hands out its chunks, and chooses the ledger for its calls: both are in the shared folder
//! (`--shard`), or in a database (`--queue`).

use crate::{
    calls::Keeping, error::Error, generate::workers::args::AskedWorkers, output::Output, settings::Service,
    stores::RunPlace,
};
use serde::{Deserialize, Serialize};
use std::path::Path;
use wayword_queue::{Beat, Board, Heart, Part, Plan, Shard, WAY, chunk_folder, put_new};

/// How the chunks of a run are handed out. All workers of a run must use the same way; a file in its folder records which.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Way {
    /// Each worker has a fixed part.
    Shards,
    /// A database hands out the open chunks. This is its name, without a password.
    Queue(String),
}

impl Way {
    /// Reads how the chunks of a folder are handed out; `None` before its first worker.
    ///
    /// # Errors
    /// When its file cannot be read.
    pub fn of(folder: &Path) -> Result<Option<Self>, Error> {
        let path = folder.join(WAY);
        if !path.exists() {
            return Ok(None);
        }
        let text = crate::text_file::read(&path, "read how chunks are handed out")?;
        serde_json::from_str(&text).map(Some).map_err(|error| {
            Error::usage(format!("{}: {error}", path.display()), "it was changed by hand: use another folder")
        })
    }

    /// Records this choice in the folder of the run, or refuses it if other workers use another one.
    fn keep(&self, place: &RunPlace) -> Result<(), Error> {
        let (folder, path) = (place.folder(), place.folder().join(WAY));
        let text = serde_json::to_string(self).unwrap_or_default();
        put_new(&path, text.as_bytes())?;
        place.publish(WAY)?;
        match Self::of(folder)? {
            Some(kept) if kept == *self => Ok(()),
            kept => Err(Error::usage(
                format!(
                    "{}: its workers take chunks by {}, not by {self}",
                    place.named().display(),
                    kept.unwrap_or(Self::Shards)
                ),
                "give the same flag (--shard or --queue) and the same database to all workers, or another --out",
            )),
        }
    }
}

impl std::fmt::Display for Way {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Shards => write!(f, "--shard"),
            Self::Queue(name) => write!(f, "--queue {name}"),
        }
    }
}

/// The board from which this worker takes its chunks.
pub(super) enum Counter<'a> {
    Shard {
        folder: &'a Path,
        plan: &'a Plan,
        part: Part,
        heart: Heart,
    },
    #[cfg(feature = "queue")]
    Queue {
        queue: wayword_queue::Queue,
        database: wayword_database::Database,
        lease: std::time::Duration,
    },
}

impl<'a> Counter<'a> {
    /// Joins the workers of a run.
    pub(super) fn open(place: &'a RunPlace, plan: &'a Plan, worker: &str, asked: &AskedWorkers) -> Result<Self, Error> {
        match (asked.shard, &asked.queue) {
            (Some(part), _) => {
                let (folder, token) = (place.folder(), worker.to_owned());
                Way::Shards.keep(place)?;
                let beat = Beat { worker: token.clone(), token, part: format!("shard {part}") };
                let heart = Heart::start(folder, &part.name(), beat, asked.lease(), |file| part.overlaps(file))?;
                Ok(Self::Shard { folder, plan, part, heart })
            }
            (None, Some(name)) => Self::queue(place, plan, name, worker, asked),
            (None, None) => Err(Error::usage("this worker has no part", "give --shard or --queue")),
        }
    }

    #[cfg(feature = "queue")]
    fn queue(place: &RunPlace, plan: &Plan, name: &str, worker: &str, asked: &AskedWorkers) -> Result<Self, Error> {
        let database = wayword_database::Database::named(name, asked.password_env.as_deref())?;
        Way::Queue(name.to_owned()).keep(place)?;
        let queue = wayword_queue::Queue::open(database.clone(), place.folder(), plan)?.join(worker, asked.lease())?;
        Ok(Self::Queue { queue, database, lease: asked.lease() })
    }

    #[cfg(not(feature = "queue"))]
    fn queue(_: &RunPlace, _: &Plan, _: &str, _: &str, _: &AskedWorkers) -> Result<Self, Error> {
        Err(Error::not_built("--queue cannot be used: this build has no way to a database"))
    }

    /// The ledger for this worker's calls.
    pub(super) fn kept_calls(&self) -> Keeping {
        match self {
            Self::Shard { folder, plan, part, .. } => {
                let recordings = part.chunks(plan).map(|chunk| calls_of(&chunk_folder(folder, chunk, 0)));
                Keeping::Chunks(recordings.filter(|path| path.exists()).collect())
            }
            #[cfg(feature = "queue")]
            Self::Queue { database, lease, .. } => Keeping::Database(database.clone(), *lease),
        }
    }

    /// Runs `work` with the board.
    pub(super) fn with<T>(&self, work: impl FnOnce(&dyn Board) -> T) -> T {
        match self {
            Self::Shard { folder, plan, part, heart } => work(&Shard::new(folder, plan, *part, heart)),
            #[cfg(feature = "queue")]
            Self::Queue { queue, .. } => work(queue),
        }
    }

    /// Writes the marks that killed workers of a queue did not write.
    pub(super) fn close(&self) -> Result<(), Error> {
        match self {
            Self::Shard { .. } => Ok(()),
            #[cfg(feature = "queue")]
            Self::Queue { queue, .. } => Ok(queue.mark().map(drop)?),
        }
    }
}

/// The recording of a chunk's calls.
pub(crate) fn calls_of(chunk: &Path) -> std::path::PathBuf {
    chunk.join("calls.jsonl")
}

/// The limits of one worker: a shard gets its part of the budget and the rates; a worker of a queue gets the whole, because the
/// database counts for all workers together.
pub(super) fn part_of(service: &Service, asked: &AskedWorkers, output: &Output) -> Result<Service, Error> {
    if service.ledger.is_some() {
        return Err(Error::usage(
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
    let said = [
        own.max_usd.map(|usd| format!("${usd:.4} of --max-usd")),
        own.max_calls.map(|calls| format!("{calls} of --max-calls")),
        own.requests_per_minute.map(|rate| format!("{rate:.2} of --requests-per-minute")),
        own.tokens_per_minute.map(|rate| format!("{rate:.0} of --tokens-per-minute")),
    ];
    let said: Vec<String> = said.into_iter().flatten().collect();
    if !said.is_empty() {
        output.say(format_args!("shard {part} may use a part of the whole run's: {}", said.join(", ")));
    }
    Ok(own)
}

//! The flags of a run that many workers make.

use clap::Args;
use std::{num::NonZeroUsize, time::Duration};
use wayword_queue::ShardPart;

/// Default number of items in a chunk.
const DEFAULT_CHUNK_ITEMS: usize = 64;

/// Which part of a run this worker makes.
#[derive(Debug, Clone, Default, Args)]
pub struct AskedWorkers {
    /// Only write the plan of the run into the folder: items, chunks, hashes of the inputs, expected cost. Workers refuse other
    /// settings and other data. The first worker writes it if it is missing.
    #[arg(long)]
    pub plan: bool,
    /// Items in a chunk, which one worker makes as a whole. [default: 64, or with --shard less if otherwise a worker had none]
    #[arg(long, value_name = "N")]
    pub chunk: Option<NonZeroUsize>,
    /// Make this part of the run: K from 0 to N-1. Needs only a folder that all workers share. Each chunk keeps its own calls,
    /// and --max-usd, --max-calls and the rates are divided by N.
    #[arg(long, value_name = "K/N", conflicts_with = "queue")]
    pub shard: Option<ShardPart>,
    /// Make whatever chunk is open in this PostgreSQL database (15 or later), until none is left. All workers share one ledger, one
    /// budget and one rate there. A name, or postgresql://USER@HOST/NAME without a password: that comes from PGPASSFILE or
    /// --password-env.
    #[arg(long, value_name = "DATABASE")]
    pub queue: Option<String>,
    /// Environment variable that holds the password of the database.
    #[arg(long, value_name = "NAME", requires = "queue")]
    pub password_env: Option<String>,
    /// How long a sign of life of a worker counts, seconds.
    #[arg(long, value_name = "S", default_value_t = 60.0, hide = true)]
    pub lease_s: f64,
}

impl AskedWorkers {
    /// Whether the run is made by many workers.
    #[must_use]
    pub fn is_asked(&self) -> bool {
        self.plan || self.shard.is_some() || self.queue.is_some()
    }

    /// Items in a chunk of a run with so many items. Where the number of workers is known, each gets a chunk if there are enough items.
    #[must_use]
    pub fn chunk_items(&self, items: usize, workers: Option<usize>) -> usize {
        let workers = workers.or(self.shard.map(|part| part.n));
        let even = workers.map_or(DEFAULT_CHUNK_ITEMS, |workers| even_chunk(items, workers));
        self.chunk.map_or(even.min(DEFAULT_CHUNK_ITEMS), NonZeroUsize::get)
    }

    /// How long a sign of life counts.
    #[must_use]
    pub fn lease_duration(&self) -> Duration {
        Duration::try_from_secs_f64(self.lease_s)
            .unwrap_or(wayword_queue::HEARTBEAT_LEASE)
            .max(Duration::from_millis(500))
    }
}

/// The largest chunk with which each worker has one: of one item, if there are fewer items than workers.
pub(super) fn even_chunk(items: usize, workers: usize) -> usize {
    let fits = |chunk: &usize| items.div_ceil(*chunk) >= workers;
    Some(items.div_ceil(workers.max(1)))
        .filter(|chunk| *chunk > 0 && fits(chunk))
        .unwrap_or((items / workers.max(1)).max(1))
}

//! A run that many workers make: its plan, chunks, claims and completion, and the scripts that launch workers.
//!
//! The plan ([`Plan`]) is written once and contains everything that all workers must agree on. It cuts the items into
//! chunks. A [`Board`] hands chunks to workers. There are two: [`Shard`] needs only a shared folder and gives each worker a
//! fixed part; a queue in PostgreSQL (feature `postgres`) gives the next open chunk to the worker that asks. The result of
//! a chunk is recorded once, in its mark ([`Done`]), a small file.
//!
//! This crate knows chunks by their numbers. The caller defines the items and makes them.

mod board;
#[cfg(feature = "cloud")]
pub mod cloud;
mod done;
mod error;
mod folder;
mod heartbeat;
pub mod launch;
mod plan;
mod protocol;
#[cfg(feature = "postgres")]
mod queue;
mod shard;
mod work;

pub use board::{Board, Claimed, Left};
pub use done::{Done, chunk_folder, dead_of, dead_path, done_of, done_path, failing, reopen};
pub use error::QueueError;
pub use folder::{put_new, put_whole, sync_tree};
pub use heartbeat::{Alive, Beat, FRESH, Heart, beats, worker_name};
pub use plan::{FILE as PLAN, Plan, WAY};
pub use protocol::{Row, State, TRIES};
#[cfg(feature = "postgres")]
pub use queue::{Queue, Seen, TABLES, Worker};
pub use shard::{Part, Shard};
pub use work::{Ended, Finished, work};

//! A run that many workers make: its plan, chunks, claims and completion, and the scripts that launch workers.
//!
//! The plan ([`ChunkPlan`]) is written once and contains everything that all workers must agree on. It cuts the items into
//! chunks. A [`ChunkBoard`] hands chunks to workers. There are two: [`ShardBoard`] needs only a shared folder and gives each worker a
//! fixed part; a queue in PostgreSQL (feature `postgres`) gives the next open chunk to the worker that asks. The result of
//! a chunk is recorded once, in its mark ([`ChunkRecord`]), a small file.
//!
//! This crate knows chunks by their numbers. The caller defines the items and makes them.
//!
//! # Where things are
//! - `plan`: what all workers have to agree on.
//! - `protocol`: the rules by which chunks change hands. `queue` has the same rules in SQL.
//! - `marks`, `folder`: the small files that record a finished chunk. `chunk_files`: the hashes in them, and what differs from them.
//! - `heartbeat`: signs of life of workers that share a folder. `process_identity`: whether a process of this machine still lives.
//! - [`launch`]: scripts for Slurm and Kubernetes, in the templates `slurm.j2` and `kubernetes.j2`.
//! - `cloud/`, with the feature `cloud`: object stores; `stored_run.rs` is a run that lies in one.

mod board;
mod chunk_files;
#[cfg(feature = "cloud")]
pub mod cloud;
mod error;
mod folder;
mod heartbeat;
pub mod launch;
mod marks;
mod plan;
mod process_identity;
mod protocol;
#[cfg(feature = "postgres")]
mod queue;
mod shard;
mod worker_loop;

pub use board::{ChunkBoard, ChunkClaim, RemainingChunks};
pub use chunk_files::{CompareDepth, FileDifference, FileMark, FileMarks, compare_files, mark_files};
pub use error::QueueError;
pub use folder::{put_new, put_whole, sync_tree};
pub use heartbeat::{
    HEARTBEAT_LEASE, HeartbeatEntry, HeartbeatThread, WORKERS_FOLDER, WorkerHeartbeat, read_heartbeats, worker_name,
};
pub use marks::{
    CHUNKS_FOLDER, ChunkRecord, chunk_folder, chunk_of_folder, dead_path, done_path, failing_chunks, read_dead_mark,
    read_done_mark, reopen_chunks, set_files_aside,
};
pub use plan::{ChunkPlan, PLAN_FILE as PLAN, WORKERS_FILE};
pub use process_identity::ProcessIdentity;
pub use protocol::{ChunkRow, ChunkState, MAX_CHUNK_TRIES};
#[cfg(feature = "postgres")]
pub use queue::{ChunkQueue, QUEUE_TABLES, QueueStatus, QueueWorker};
pub use shard::{ShardBoard, ShardPart};
pub use worker_loop::{ChunkOutcome, WorkSummary, work_chunks};

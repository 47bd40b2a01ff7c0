//! The texts that start workers elsewhere: a script for Slurm, and a manifest for Kubernetes.
//!
//! Both start the same command `workers` times. If its arguments name neither a queue nor a shard, each worker gets the shard
//! of its number. Comments in the texts explain each of their lines, because the people who run a cluster read them first.
//!
//! Invariants for all values of a user:
//! - Each value is quoted: single quotes for bash, JSON strings for YAML. A template that prints a text without one of the two is an
//!   error.
//! - A line break or another control character is refused, so no value can begin a new line.
//! - A password is refused. The texts name secrets and never contain them.
//!
//! The manifest was never sent to a Kubernetes server, because no cluster was at hand. The tests compare it with the published
//! schemas, and with the rules in the schemas' descriptions. The script was run on Slurm 22.05 (`trials/scale/slurm.sh`).

mod check;
mod error;
pub mod kubernetes;
mod quote;
pub mod slurm;
mod worker;

pub use error::LaunchError;
pub use worker::LaunchWorker;

/// Most workers of one launch. Above this number Kubernetes limits the failed indexes of a Job to 10,000; Slurm's arrays end long before.
pub const MAX_WORKERS: u32 = 100_000;

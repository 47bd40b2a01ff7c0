//! The texts that start workers elsewhere: a script for Slurm, and a manifest for Kubernetes.
//!
//! Both start `workers` times the same command. If its arguments name neither a queue nor a part, each worker gets the part of
//! its number. The texts say in comments why each of their lines is there, because those who run a cluster read them first.
//!
//! What must hold, whatever the user gives:
//! - A value is quoted where it stands: single quotes for bash, JSON's texts for YAML. A template that prints a text without one of
//!   the two is an error.
//! - A line break or another control character is refused, so no value can begin a line of its own.
//! - A password is refused. Texts name secrets; they never hold them.
//!
//! What a server of Kubernetes makes of the manifest is unverified: no cluster was at hand. The tests hold it against the published
//! schemas, and against the rules that the schemas' descriptions name. The script was run on Slurm 22.05 (`trials/scale/slurm.sh`).

mod check;
mod error;
pub mod kubernetes;
mod quote;
pub mod slurm;
mod worker;

pub use error::LaunchError;
pub use worker::{WORKERS, Worker};

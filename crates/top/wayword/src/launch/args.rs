//! The flags of `wayword launch`.

use clap::{Args, Subcommand};
use std::str::FromStr;

/// `wayword launch`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword launch slurm --workers 40 --gpus 1 --time 4:00:00 -- generate --paths 100000 --out /shared/big
  wayword launch slurm --workers 40 --time 4:00:00 --export PGPASSFILE --submit -- generate --paths 100000 --out /shared/big --queue postgresql://me@db/wayword
  wayword launch kubernetes --workers 40 --image ghcr.io/me/wayword --shared-claim runs=/shared -- generate --paths 100000 --out /shared/big | kubectl apply -f -

Workers without --queue get their parts by --shard. A worker's exit codes:
  0  nothing is left for it; rejected texts are results
  1  wrong input, 2  wrong command line: the others would end the same way
  4  another worker has its part: it is tried again later
  5  the budget is spent, or a key was refused
  6  stopped by a signal; its work was handed back
  7  the simulator, a service or the disk failed; it is tried again a few times")]
pub struct LaunchArgs {
    /// Where.
    #[command(subcommand)]
    pub command: LaunchCommand,
}

/// Where workers are started.
#[derive(Debug, Subcommand)]
pub enum LaunchCommand {
    /// Print a script for Slurm's sbatch: an array of workers.
    Slurm(LaunchSlurm),
    /// Print a manifest for Kubernetes: an Indexed Job.
    Kubernetes(LaunchKubernetes),
}

/// `wayword launch slurm`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword launch slurm --workers 40 --gpus 1 --time 4:00:00 -- generate --paths 100000 --out /shared/big > big.sh
  wayword launch slurm --workers 40 --time 4:00:00 --submit -- generate --paths 100000 --out /shared/big")]
pub struct LaunchSlurm {
    /// Number of workers. Clusters often end arrays at 1,001.
    #[arg(long, value_name = "N")]
    pub workers: u32,
    /// How long one start of a worker may take, as Slurm writes it. A worker that is stopped then hands its work back, and goes on
    /// after it is queued again.
    #[arg(long, value_name = "TIME")]
    pub time: String,
    /// GPUs of each worker.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub gpus: u32,
    /// CPUs of each worker.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub cpus: u32,
    /// Memory of each worker, as Slurm writes it: 16G. [default: the cluster's]
    #[arg(long, value_name = "SIZE")]
    pub memory: Option<String>,
    /// Where to run. [default: the cluster's]
    #[arg(long, value_name = "NAME")]
    pub partition: Option<String>,
    /// Whom the time is charged to. [default: the cluster's]
    #[arg(long, value_name = "NAME")]
    pub account: Option<String>,
    /// Name of the array.
    #[arg(long, default_value = "wayword")]
    pub name: String,
    /// Folder for the logs. It has to be there when the script is submitted; --submit makes it.
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub logs: String,
    /// Environment variable that workers get from who submits, such as PGPASSFILE or the variable of a key. May be given several times.
    #[arg(long, value_name = "NAME")]
    pub export: Vec<String>,
    /// The program that each worker runs.
    #[arg(long, value_name = "PATH", default_value = "wayword")]
    pub program: String,
    /// Send the script to sbatch instead of printing it.
    #[arg(long)]
    pub submit: bool,
    /// What each worker does: `generate` and its flags.
    #[arg(last = true, required = true)]
    pub arguments: Vec<String>,
}

/// `wayword launch kubernetes`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword launch kubernetes --workers 40 --image ghcr.io/me/wayword --shared-claim runs=/shared \\
      -- generate --paths 100000 --out /shared/big | kubectl apply -f -")]
pub struct LaunchKubernetes {
    /// Number of workers.
    #[arg(long, value_name = "N")]
    pub workers: u32,
    /// Image that has the program (see docs/BUILD.md).
    #[arg(long)]
    pub image: String,
    /// GPUs of each worker.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub gpus: u32,
    /// CPUs of each worker: 2, 500m.
    #[arg(long, value_name = "N", default_value = "1")]
    pub cpus: String,
    /// Memory of each worker: 16Gi.
    #[arg(long, value_name = "SIZE", default_value = "2Gi")]
    pub memory: String,
    /// Name of the job.
    #[arg(long, default_value = "wayword")]
    pub name: String,
    /// Namespace of the job. [default: the one that kubectl is set to]
    #[arg(long, value_name = "NAME")]
    pub namespace: Option<String>,
    /// The folder that all workers share: a PersistentVolumeClaim, and where it is mounted.
    #[arg(long, value_name = "CLAIM=DIR")]
    pub shared_claim: Option<LaunchPair>,
    /// An environment variable from a secret. May be given several times.
    #[arg(long, value_name = "VARIABLE=SECRET/KEY")]
    pub secret: Vec<LaunchPair>,
    /// The password file of PostgreSQL, from a secret. PGPASSFILE names it.
    #[arg(long, value_name = "SECRET/KEY")]
    pub pass_file: Option<String>,
    /// What each worker does: `generate` and its flags.
    #[arg(last = true, required = true)]
    pub arguments: Vec<String>,
}

/// Two words with `=` between them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LaunchPair {
    /// The first.
    pub left: String,
    /// The second.
    pub right: String,
}

impl FromStr for LaunchPair {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let (left, right) = typed.split_once('=').ok_or("there is no =")?;
        Ok(Self { left: left.to_owned(), right: right.to_owned() })
    }
}

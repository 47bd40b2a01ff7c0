//! The flags of `wayword runs`.

use clap::{Args, Subcommand};
use std::path::PathBuf;

/// `wayword runs`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword runs status runs/big --watch
  wayword runs status runs/big --prometheus > /var/lib/node_exporter/wayword.prom
  wayword runs merge runs/big
  wayword runs merge s3://bucket/big --out runs/big
  wayword runs retry runs/big --reason timeout
  wayword runs retry runs/big --damaged
  wayword runs database wayword_db --sql --role workers | psql wayword_db")]
pub struct RunsArgs {
    /// What to do.
    #[command(subcommand)]
    pub command: RunsCommand,
}

/// What to do with a run that many workers make.
#[derive(Debug, Subcommand)]
pub enum RunsCommand {
    /// Show what is done, running, failed and given up, how fast it goes, and who is at work.
    Status(RunsStatus),
    /// Put the chunks together, to the files that one machine would have made.
    Merge(RunsMerge),
    /// Open chunks again that have failures, damaged files, or were given up for a reason.
    Retry(RunsRetry),
    /// Make the tables of the queue and the ledger in a database, or print the statements that do so.
    Database(RunsDatabase),
}

/// The queue of a run.
#[derive(Debug, Args)]
pub struct RunsQueue {
    /// The database of a run in an object store. A run in a folder names its own.
    #[arg(long, value_name = "DATABASE")]
    pub queue: Option<String>,
    /// Environment variable that holds the password of the database.
    #[arg(long, value_name = "NAME")]
    pub password_env: Option<String>,
}

/// `wayword runs status`.
#[derive(Debug, Args)]
#[command(after_long_help = "Examples:\n  wayword runs status runs/big\n  wayword runs status runs/big --watch")]
pub struct RunsStatus {
    /// The run folder, or its address in an object store.
    pub run: PathBuf,
    /// Show it again every few seconds, until no chunk is left.
    #[arg(long)]
    pub watch: bool,
    /// Print it as Prometheus reads it (text format), for the textfile collector of a node exporter.
    #[arg(long, conflicts_with = "watch")]
    pub prometheus: bool,
    /// Its queue.
    #[command(flatten)]
    pub database: RunsQueue,
}

/// `wayword runs merge`.
#[derive(Debug, Args)]
#[command(
    after_long_help = "Examples:\n  wayword runs merge runs/big\n  wayword runs merge s3://bucket/big --out runs/big"
)]
pub struct RunsMerge {
    /// The run folder, or its address in an object store.
    pub run: PathBuf,
    /// Fetch a run from an object store into this folder, and merge it there. Needs a build with the feature cloud.
    #[arg(long = "out", alias = "to", value_name = "DIR")]
    pub to: Option<PathBuf>,
    /// Put together what is finished, although chunks are missing. Merge again later for the whole.
    #[arg(long)]
    pub partial: bool,
}

/// `wayword runs retry`.
#[derive(Debug, Args)]
#[command(after_long_help = "Examples:\n  wayword runs retry runs/big --reason timeout")]
pub struct RunsRetry {
    /// The run folder, or its address in an object store.
    pub run: PathBuf,
    /// Words of the reason, as `wayword runs status` shows it.
    #[arg(long, value_name = "WORDS", required_unless_present_any = ["damaged", "chunk"])]
    pub reason: Option<String>,
    /// Make the finished chunks anew whose files no longer fit their marks, as `wayword runs status` shows them. The old files stay
    /// in a folder beside each chunk.
    #[arg(long, conflicts_with_all = ["reason", "chunk"])]
    pub damaged: bool,
    /// Make these finished chunks anew, by their numbers. The old files stay in a folder beside each chunk.
    #[arg(long, value_name = "N,...", value_delimiter = ',', conflicts_with = "reason")]
    pub chunk: Vec<usize>,
    /// Its queue.
    #[command(flatten)]
    pub database: RunsQueue,
}

/// `wayword runs database`.
#[derive(Debug, Args)]
#[command(
    after_long_help = "Examples:\n  wayword runs database wayword_db\n  wayword runs database wayword_db --sql --role workers | psql wayword_db"
)]
pub struct RunsDatabase {
    /// The database: a name, or postgresql://USER@HOST/NAME without a password.
    pub database: String,
    /// Only print the statements.
    #[arg(long)]
    pub sql: bool,
    /// Also give this role the rights that a worker needs, and no others.
    #[arg(long, value_name = "ROLE")]
    pub role: Option<String>,
    /// Environment variable that holds the password of the database.
    #[arg(long, value_name = "NAME")]
    pub password_env: Option<String>,
}

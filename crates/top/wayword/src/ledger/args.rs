//! The flags of `wayword ledger`.

use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;
use wayword_ledger::{CostGrouping, LedgerFilter};

/// `wayword ledger`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword ledger show --model ollama/llava --limit 5
  wayword ledger cost --by run
  wayword ledger export --out calls.jsonl
  wayword ledger prune --older-than-days 180
  wayword ledger prune --changed")]
pub struct LedgerArgs {
    /// What to do.
    #[command(subcommand)]
    pub command: LedgerCommand,
    /// File of the ledger. [default: wayword/ledger.db in the data folder of your system; on Linux ~/.local/share]
    #[arg(long, value_name = "FILE", global = true)]
    pub ledger: Option<PathBuf>,
}

/// What to do with the ledger.
#[derive(Debug, Subcommand)]
pub enum LedgerCommand {
    /// Show the latest calls, with their answers.
    #[command(
        after_long_help = "Examples:\n  wayword ledger show --limit 5\n  wayword ledger show --model ollama/llava"
    )]
    Show {
        /// Which calls.
        #[command(flatten)]
        filter: CallFilter,
        /// Show at most this many calls.
        #[arg(long, value_name = "N", default_value_t = 20)]
        limit: usize,
    },
    /// Show what the calls cost.
    #[command(after_long_help = "Examples:\n  wayword ledger cost\n  wayword ledger cost --by run")]
    Cost {
        /// Add the costs up per model, run or day.
        #[arg(long, default_value = "model")]
        by: SumBy,
    },
    /// Write calls as JSON lines, which `--replay` can read.
    #[command(
        after_long_help = "Examples:\n  wayword ledger export --out calls.jsonl\n  wayword ledger export --model ollama/llava --out llava.jsonl"
    )]
    Export {
        /// Which calls.
        #[command(flatten)]
        filter: CallFilter,
        /// The file to write.
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
    },
    /// Delete calls. A run that needs one of them later pays for it again.
    #[command(
        after_long_help = "Examples:\n  wayword ledger prune --older-than-days 180\n  wayword ledger prune --changed"
    )]
    Prune {
        /// Delete calls that are older than this.
        #[arg(long, value_name = "DAYS")]
        older_than_days: Option<u64>,
        /// Delete the calls of this model.
        #[arg(long, value_name = "MODEL")]
        model: Option<String>,
        /// Delete calls with a wrong checksum of the answer, because it was changed later.
        #[arg(long, conflicts_with_all = ["older_than_days", "model"])]
        changed: bool,
    },
}

/// Which calls.
#[derive(Debug, Args)]
pub struct CallFilter {
    /// Only calls of this model, as provider/model.
    #[arg(long, value_name = "MODEL")]
    pub model: Option<String>,
    /// Only calls of this run. Its name is in the file run.id of the run folder.
    #[arg(long, value_name = "RUN")]
    pub run: Option<String>,
}

impl CallFilter {
    /// The filter that the ledger takes.
    #[must_use]
    pub fn to_filter(&self) -> LedgerFilter {
        LedgerFilter { model: self.model.clone(), run: self.run.clone(), ..LedgerFilter::default() }
    }
}

/// The key by which costs are added up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SumBy {
    /// Model by model.
    Model,
    /// Run by run.
    Run,
    /// Day by day (UTC).
    Day,
}

impl From<SumBy> for CostGrouping {
    fn from(by: SumBy) -> Self {
        match by {
            SumBy::Model => CostGrouping::Model,
            SumBy::Run => CostGrouping::Run,
            SumBy::Day => CostGrouping::Day,
        }
    }
}

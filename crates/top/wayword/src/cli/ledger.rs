//! `wayword ledger` as it is typed.

use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;
use wayword_ledger::{By, Filter};

/// `wayword ledger`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword ledger show --model ollama/llava --limit 5
  wayword ledger cost --by run
  wayword ledger export --out calls.jsonl
  wayword ledger prune --older-than-days 180
  wayword ledger prune --changed")]
pub struct Ledger {
    /// What to do.
    #[command(subcommand)]
    pub command: LedgerCommand,
    /// The ledger. [default: wayword/ledger.db in your data folder]
    #[arg(long, value_name = "FILE", global = true)]
    pub ledger: Option<PathBuf>,
}

/// What to do with the ledger.
#[derive(Debug, Subcommand)]
pub enum LedgerCommand {
    /// The latest calls, with their answers.
    Show {
        /// Which calls.
        #[command(flatten)]
        filter: CallFilter,
        /// Most calls to show.
        #[arg(long, value_name = "N", default_value_t = 20)]
        limit: usize,
    },
    /// What calls have cost.
    Cost {
        /// Sum up by this.
        #[arg(long, default_value = "model")]
        by: SumBy,
    },
    /// Write calls as JSON lines, which --replay can read.
    Export {
        /// Which calls.
        #[command(flatten)]
        filter: CallFilter,
        /// The file to write.
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
    },
    /// Drop calls; asking them again will cost again.
    Prune {
        /// Those that are older.
        #[arg(long, value_name = "DAYS")]
        older_than_days: Option<u64>,
        /// Those of this model.
        #[arg(long, value_name = "MODEL")]
        model: Option<String>,
        /// Those whose answer was changed after it was written.
        #[arg(long, conflicts_with_all = ["older_than_days", "model"])]
        changed: bool,
    },
}

/// Which calls.
#[derive(Debug, Args)]
pub struct CallFilter {
    /// Only this model's, as provider/model.
    #[arg(long, value_name = "MODEL")]
    pub model: Option<String>,
    /// Only this run's, by the name in its folder's run.id.
    #[arg(long, value_name = "RUN")]
    pub run: Option<String>,
}

impl CallFilter {
    /// The filter that the ledger takes.
    #[must_use]
    pub fn filter(&self) -> Filter {
        Filter { model: self.model.clone(), run: self.run.clone(), ..Filter::default() }
    }
}

/// What costs are summed up by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SumBy {
    /// Model by model.
    Model,
    /// Run by run.
    Run,
    /// Day by day (UTC).
    Day,
}

impl From<SumBy> for By {
    fn from(by: SumBy) -> Self {
        match by {
            SumBy::Model => By::Model,
            SumBy::Run => By::Run,
            SumBy::Day => By::Day,
        }
    }
}

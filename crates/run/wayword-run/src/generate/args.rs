//! The flags of `wayword generate`.

use super::workers::args::AskedWorkers;
use crate::settings::AskedSettings;
use clap::Args;
use std::path::PathBuf;

/// `wayword generate`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword generate --paths 20 --out runs/houses
  wayword generate --paths 500 --houses 500 --out runs/500      (each path in a house of its own)
  wayword generate --platform matterport --data DATA --paths 200 --hops 4..7 --metres 5..20 --seed 1 --out runs/random
  wayword generate --platform matterport --data DATA --episodes REVERIE_val_seen.json --style reverie --style r2r --out runs/val_seen
  wayword generate --platform habitat --data SCENES --connectivity GRAPHS --paths 200 --out runs/scans
  wayword generate --style mine.toml --style r2r=R2R_train.json --out runs/styles
  wayword generate --paths 20 --llm ollama/qwen3 --see ollama/llava --out runs/models
  wayword generate --paths 20 --llm openai/gpt-4.1-mini --see openai/gpt-4.1-mini --max-usd 2 --dry-run
  wayword generate --config run.toml --seed 7 --out runs/seven      (flags win over the file)
  wayword generate --paths 100000 --out runs/big --plan             (then, on many machines, the same with:)
  wayword generate --paths 100000 --out runs/big --shard 3/64       (or: --queue wayword_db)
  wayword generate --paths 20 --out runs/houses --spans runs/houses-spans")]
pub struct GenerateArgs {
    /// Folder for the run; required without --dry-run. Give the same command again to continue it.
    #[arg(long, value_name = "DIR", required_unless_present = "dry_run")]
    pub out: Option<PathBuf>,
    /// Settings as TOML, with the names of these flags. A flag wins over the file. Paths in the file start, like those of flags,
    /// where the command is run.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Estimate the calls, tokens and money that the run would need, without making a call. The real run may need
    /// more, because questions that are asked twice and texts that are rewritten are not counted.
    #[arg(long)]
    pub dry_run: bool,
    /// Write what happens as spans into a file of this process in this folder: a line of JSON for the process and for each
    /// chunk, item and call of a model, when it ends, with its parent and how long it took. Without words of prompts and
    /// answers.
    #[arg(long, value_name = "FOLDER", conflicts_with = "dry_run")]
    pub spans: Option<PathBuf>,
    /// Which part of it this worker makes.
    #[command(flatten)]
    pub workers: AskedWorkers,
    /// The run.
    #[command(flatten)]
    pub asked: AskedSettings,
}

//! The command line of `wayword evaluate`.

use crate::compare::args::SuccessRule;
use clap::Args;
use std::path::PathBuf;
use wayword_run::settings::AskedPlatform;

/// `wayword evaluate`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword evaluate submission.json --episodes REVERIE_val_seen.json --platform matterport --data DATA
      Success, path length and fidelity, by REVERIE's official rule (target visible) and by R2R's (under 3 m).
  wayword evaluate submission.json --episodes R2R_val_seen.json --platform matterport --data DATA --per-item scores.jsonl
  wayword evaluate runs/table/submissions/clip-nav.original.json --episodes REVERIE_val_seen.json \\
      --platform matterport --data DATA --rule visible --partial --json
      A submission that `wayword compare` wrote. It may lack items, because `compare` walks only the items that all its sets have.

A submission is a JSON list of {\"instr_id\": \"ID_N\", \"trajectory\": [[viewpoint, heading, elevation], ...], \"predObjId\": OBJECT},
plain or gzip. ID_N is instruction N (from 0) of item ID. Every instruction needs an entry, except with --partial. If an entry is wrong, nothing is scored, the problems
are listed (20 on the screen, more with --json), and the exit code is 1.")]
pub struct EvaluateArgs {
    /// File of trajectories, as the evaluators of R2R and REVERIE take it.
    #[arg(value_name = "SUBMISSION")]
    pub submission: PathBuf,
    /// File of the episodes that were walked: R2R, REVERIE, RxR, VLN-CE or Wayword.
    #[arg(long, value_name = "FILE")]
    pub episodes: PathBuf,
    /// The platform.
    #[command(flatten)]
    pub platform: AskedPlatform,
    /// Score a submission that covers only a part of the instructions, and print how many it covers. Leaderboards want every one.
    #[arg(long)]
    pub partial: bool,
    /// Use only this rule of success. [default: every rule that can be applied]
    #[arg(long)]
    pub rule: Option<SuccessRule>,
    /// Also write the figures of each instruction to this file, one JSON object per line.
    #[arg(long, value_name = "FILE")]
    pub per_item: Option<PathBuf>,
    /// Use only the first N items of the episodes, as `wayword compare --limit` does. Trajectories of later items are ignored.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub limit: Option<u32>,
    /// Number of bootstrap resamples for the intervals.
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(100..=100_000))]
    pub resamples: u32,
    /// Seed of the intervals.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
}

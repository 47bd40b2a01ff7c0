//! `wayword evaluate` as it is typed.

use super::SuccessRule;
use crate::settings::World;
use clap::Args;
use std::path::PathBuf;

/// `wayword evaluate`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword evaluate submission.json --episodes REVERIE_val_seen.json --platform matterport --data DATA
      Success, path length and fidelity of anyone's trajectories, by REVERIE's official rule and by the lenient one.
  wayword evaluate submission.json --episodes R2R_val_seen.json --platform matterport --data DATA --per-item scores.jsonl
  wayword evaluate runs/table/submissions/clip-nav.original.json --episodes REVERIE_val_seen.json \\
      --platform matterport --data DATA --rule visible --partial --json
      What `wayword compare` left of its agents' walks: of the items that all its sets have, and not of every one.

A submission is a JSON list of {\"instr_id\": \"ID_PLACE\", \"trajectory\": [[viewpoint, heading, elevation], ...], \"predObjId\": OBJECT},
plain or gzip; one item for every instruction, except with --partial. If anything is wrong with it, nothing is scored, all that is
wrong is told (20 problems on a screen, --json more), and the exit code is 1.")]
pub struct Evaluate {
    /// The trajectories, as the evaluators of R2R and REVERIE take them.
    #[arg(value_name = "SUBMISSION")]
    pub submission: PathBuf,
    /// The episodes that were walked: R2R, REVERIE, RxR or Wayword.
    #[arg(long, value_name = "FILE")]
    pub episodes: PathBuf,
    /// The world.
    #[command(flatten)]
    pub world: World,
    /// Score a submission that lacks instructions by those that it has, and say how many they are. Leader boards want all.
    #[arg(long)]
    pub partial: bool,
    /// Only this rule of success. [default: every rule that can be applied]
    #[arg(long)]
    pub rule: Option<SuccessRule>,
    /// Where to put the figures of each instruction, one JSON object per line.
    #[arg(long, value_name = "FILE")]
    pub per_item: Option<PathBuf>,
    /// Only the first so many items of the episodes, as `wayword compare --limit` walks them; trajectories for later ones are left
    /// out.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub limit: Option<u32>,
    /// Resamples of the intervals.
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(100..=100_000))]
    pub resamples: u32,
    /// Seed of the intervals.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
}

//! `wayword similarity` as it is typed.

use clap::{Args, ValueEnum};

/// `wayword similarity`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword similarity runs/val_seen#reverie REVERIE_val_seen.json
      How alike a run and people are, beside how alike two people are, and what chance reaches.
  wayword similarity runs/a runs/b --style r2r --json
  wayword similarity runs/val_seen#r2r R2R_val_seen.json --by path
      Items of different datasets on the same paths.
  wayword similarity runs/a runs/b --style r2r --encoder words      (no model: words are counted)")]
pub struct Similarity {
    /// Instructions: a run folder, or a file in R2R, REVERIE, RxR, VLN-CE or Wayword format; #STYLE at its end names one style.
    #[arg(value_name = "A")]
    pub a: String,
    /// What they are held against, the same way; both anchors are taken from these.
    #[arg(value_name = "B")]
    pub b: String,
    /// What has to be the same for two texts to be compared.
    #[arg(long, default_value = "item")]
    pub by: By,
    /// The sentence encoder: hf/ORG/NAME, or words, which is none.
    #[arg(long, value_name = "MODEL", default_value = "hf/sentence-transformers/all-MiniLM-L6-v2")]
    pub encoder: String,
    /// Only this style of runs and Wayword files.
    #[arg(long, value_name = "STYLE")]
    pub style: Option<String>,
    /// Resamples of the intervals.
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(100..=100_000))]
    pub resamples: u32,
    /// Seed of the intervals and of the random pairs.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
}

/// What two texts have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum By {
    /// The item: its id.
    Item,
    /// The path: its scene and path id, whatever the object at its end.
    Path,
}

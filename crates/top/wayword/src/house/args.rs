//! The flags of `wayword house`.

use clap::Args;
use std::path::PathBuf;

/// `wayword house`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword house --seed 7 --out houses
  wayword house --seed 0 --houses 20 --paths 200 --out houses
  wayword house --run runs/houses --style r2r --out houses      (the houses of a run, with its instructions)

Habitat reads the folder: habitat-lab walks its episodes with the configuration in vln.yaml, and the platform habitat of this
program takes it as --data.")]
pub struct HouseArgs {
    /// Seed of the first house.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// How many houses, with the seeds that follow.
    #[arg(long, value_name = "N", default_value_t = 1, conflicts_with = "run")]
    pub houses: u64,
    /// Write this many episodes of VLN-CE, with instructions by labels and rules; 0 for none, as to add houses to a set.
    #[arg(long, value_name = "N", default_value_t = 10, conflicts_with = "run")]
    pub paths: usize,
    /// Instead: the houses of this run, with its instructions as episodes.
    #[arg(long, value_name = "DIR", conflicts_with = "seed")]
    pub run: Option<PathBuf>,
    /// The style of the instructions. [default: r2r; with --run its only style]
    #[arg(long, value_name = "STYLE")]
    pub style: Option<String>,
    /// Folder to write: a folder for each house, episodes/, and what Habitat reads of them.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

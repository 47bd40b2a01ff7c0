//! `wayword view` as it is typed.

use crate::settings::World;
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// `wayword view`.
#[derive(Debug, Args)]
pub struct View {
    /// What to show.
    #[command(subcommand)]
    pub command: ViewCommand,
}

/// What can be shown of a world.
#[derive(Debug, Subcommand)]
pub enum ViewCommand {
    /// All around from a viewpoint, as one picture.
    Panorama(ViewPanorama),
    /// A path as whoever walks it sees it: pictures in a folder, a GIF or a video.
    Path(ViewPath),
    /// A storey from above: where one can walk and, where asked, a path.
    Map(ViewMap),
}

/// Which path.
#[derive(Debug, Args)]
pub struct Walk {
    /// The scene of a random path. [default: the world's first; of episodes, any]
    #[arg(long, value_name = "SCENE")]
    pub scan: Option<String>,
    /// The random path of this seed, the first that `generate` makes of it. [default: 0]
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Hops of a random path. [default: 4..7]
    #[arg(long, value_name = "FROM..TO")]
    pub hops: Option<String>,
    /// Length of a random path in metres. [default: 5..20]
    #[arg(long, value_name = "FROM..TO")]
    pub metres: Option<String>,
    /// A path of a dataset: R2R, REVERIE, RxR, or Wayword (a run's instructions.jsonl too).
    #[arg(long, value_name = "FILE", conflicts_with_all = ["seed", "hops", "metres"])]
    pub episodes: Option<PathBuf>,
    /// The item whose path it is. [default: the first]
    #[arg(long, value_name = "ID", requires = "episodes")]
    pub item: Option<String>,
}

/// `wayword view panorama`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword view panorama --scan house-7 --out living.png
  wayword view panorama --platform habitat --data house.glb --viewpoint v0003 --heading-deg 90 --out east.jpg
  wayword view panorama --platform matterport --data DATA --scan SCAN --seed 3 --out start.png

The picture is a cylinder unrolled: its middle looks along the heading, and it is as high as the four views reach where they
meet. Where one of the four has no picture that part stays grey; where more have none there is no panorama.")]
pub struct ViewPanorama {
    /// The world.
    #[command(flatten)]
    pub world: World,
    /// The scene. [default: the world's first]
    #[arg(long, value_name = "SCENE")]
    pub scan: Option<String>,
    /// Where to stand. [default: the scene's first viewpoint]
    #[arg(long, value_name = "ID", conflicts_with = "seed")]
    pub viewpoint: Option<String>,
    /// Stand where the random path of this seed starts, and look as it does.
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Where the middle looks: degrees, 0 is north (+y), 90 east. [default: 0; of a path, its own]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    pub heading_deg: Option<f64>,
    /// Width of the picture. [default: what keeps the detail of the views]
    #[arg(long, value_name = "PIXELS")]
    pub width: Option<u32>,
    /// The picture: .png or .jpg.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
}

/// `wayword view path`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword view path --scan house-7 --seed 3 --out frames/
  wayword view path --scan house-7 --seed 3 --smooth 8 --out walk.mp4      (needs the feature full)
  wayword view path --platform habitat --data house.glb --metres 5..10 --smooth 8 --width 320 --out walk.gif
  wayword view path --episodes runs/houses/instructions.jsonl --item random-0-4 --out walk.gif

Each of the path's frames is shown once. With --smooth there are pictures between them: the walker turns on the spot and then
walks, at an even pace. Frames of which the world has no picture are left out, and that is told.")]
pub struct ViewPath {
    /// The world.
    #[command(flatten)]
    pub world: World,
    /// The path.
    #[command(flatten)]
    pub walk: Walk,
    /// Pictures for each second. [default: 1; with --smooth 12]
    #[arg(long, value_name = "N")]
    pub fps: Option<f64>,
    /// So many pictures between two frames, in worlds that can be seen from anywhere.
    #[arg(long, value_name = "N")]
    pub smooth: Option<usize>,
    /// Width of the pictures. [default: as the world gives them]
    #[arg(long, value_name = "PIXELS")]
    pub width: Option<u32>,
    /// What to write: a folder for numbered PNG files, or a .gif or .mp4 file.
    #[arg(long, value_name = "PLACE")]
    pub out: PathBuf,
}

/// `wayword view map`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword view map --scan house-7 --out ground.svg
  wayword view map --scan house-7 --level 2 --seed 3 --out upstairs.png
  wayword view map --platform matterport --data DATA --episodes REVERIE_val_seen.json --item 4634_215 --out path.svg

A path is drawn where one is asked for: with --seed, --hops, --metres or --episodes. Under the map lies the storey as it looks
from above, where the world has its geometry (house, habitat). In an SVG, viewpoints say their names.")]
pub struct ViewMap {
    /// The world.
    #[command(flatten)]
    pub world: World,
    /// The path.
    #[command(flatten)]
    pub walk: Walk,
    /// The storey, the lowest being 1. [default: where the path starts, else the lowest]
    #[arg(long, value_name = "N")]
    pub level: Option<u32>,
    /// The map: .svg or .png.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
}

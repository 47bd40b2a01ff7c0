//! The command line of `wayword view`.

use clap::{Args, Subcommand};
use std::path::PathBuf;
use wayword_run::settings::AskedPlatform;

/// `wayword view`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword view panorama --scan house2-7 --out living.png
  wayword view path --scan house2-7 --seed 3 --out frames/
  wayword view map --scan house2-7 --out ground.svg")]
pub struct ViewArgs {
    /// What to show.
    #[command(subcommand)]
    pub command: ViewCommand,
}

/// The subcommands of `wayword view`.
#[derive(Debug, Subcommand)]
pub enum ViewCommand {
    /// Draw everything around a viewpoint, as one picture.
    Panorama(ViewPanorama),
    /// Draw what is seen along a path: pictures in a folder or side by side, a GIF or a video.
    Path(ViewPath),
    /// Draw a storey from above: where one can walk and, if asked, a path.
    Map(ViewMap),
}

/// Which path.
#[derive(Debug, Args)]
pub struct ShownPathArgs {
    /// Use this scene. [default: the platform's first; with --episodes, that of the item]
    #[arg(long, alias = "scene", value_name = "SCENE")]
    pub scan: Option<String>,
    /// Show the first random path that `generate` makes with this seed. [default: 0, if a random path is shown]
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Number of hops of a random path, on platforms with a viewpoint graph. [default: 4..7]
    #[arg(long, value_name = "FROM..TO")]
    pub hops: Option<String>,
    /// Length of a random path in metres. [default: 5..20]
    #[arg(long, value_name = "FROM..TO")]
    pub metres: Option<String>,
    /// Show a path of this file: R2R, REVERIE, RxR, or Wayword (also the instructions.jsonl of a run).
    #[arg(long, value_name = "FILE", conflicts_with_all = ["seed", "hops", "metres"])]
    pub episodes: Option<PathBuf>,
    /// Show the path of this item. [default: the first]
    #[arg(long, value_name = "ID", requires = "episodes")]
    pub item: Option<String>,
}

/// `wayword view panorama`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword view panorama --scan house2-7 --out living.png
  wayword view panorama --platform habitat --data house.glb --viewpoint v0003 --heading-deg 90 --out east.jpg
  wayword view panorama --platform matterport --data DATA --scan SCAN --seed 3 --out start.png

The picture shows 360 degrees, with the heading in its centre. It is made of four views. If one of the four has no picture, that
part is grey; if more have none, no panorama is written.")]
pub struct ViewPanorama {
    /// The platform.
    #[command(flatten)]
    pub platform: AskedPlatform,
    /// Use this scene. [default: the platform's first]
    #[arg(long, alias = "scene", value_name = "SCENE")]
    pub scan: Option<String>,
    /// Stand at this viewpoint. [default: the scene's first]
    #[arg(long, value_name = "ID", conflicts_with = "seed")]
    pub viewpoint: Option<String>,
    /// Stand where the random path of this seed starts, with its heading.
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Heading of the centre in degrees: 0 is north (+y), 90 is east. [default: 0; with --seed, that of the path]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    pub heading_deg: Option<f64>,
    /// Width of the picture. [default: the full resolution of the views]
    #[arg(long, value_name = "PIXELS")]
    pub width: Option<u32>,
    /// Picture to write: .png or .jpg.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
}

/// `wayword view path`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword view path --scan house2-7 --seed 3 --out frames/
  wayword view path --scan house2-7 --seed 3 --smooth 8 --out walk.mp4      (needs the feature full)
  wayword view path --platform habitat --data house.glb --metres 5..10 --smooth 8 --width 320 --out walk.gif
  wayword view path --episodes runs/houses/instructions.jsonl --item random-0-4 --out walk.gif
  wayword view path --episodes runs/houses/instructions.jsonl --pictures 4 --width 320 --out walk.jpg      (side by side)

Each frame of the path is shown once. With --smooth there are pictures between them: the walker turns on the spot and then
walks, at an even pace. A frame without a picture is left out, and the program says so. A GIF with --smooth is
large: make it smaller with --width, or write an .mp4.")]
pub struct ViewPath {
    /// The platform.
    #[command(flatten)]
    pub platform: AskedPlatform,
    /// The path.
    #[command(flatten)]
    pub walk: ShownPathArgs,
    /// Pictures per second. [default: 1, or 12 if --smooth is given]
    #[arg(long, value_name = "N")]
    pub fps: Option<f64>,
    /// Draw this many pictures between two frames. Needs a platform that can draw from anywhere (house, habitat).
    #[arg(long, value_name = "N")]
    pub smooth: Option<usize>,
    /// Width of the pictures. [default: that of the platform's pictures]
    #[arg(long, value_name = "PIXELS")]
    pub width: Option<u32>,
    /// Number of frames that a .jpg or .png shows side by side, evenly spaced along the path. [default: 3]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=100))]
    pub pictures: Option<u16>,
    /// What to write: a folder for numbered PNG files, a .gif or .mp4 file, or a .jpg or .png with some frames side by side.
    #[arg(long, value_name = "PLACE")]
    pub out: PathBuf,
}

/// `wayword view map`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword view map --scan house2-7 --out ground.svg
  wayword view map --scan house2-7 --level 2 --seed 3 --out upstairs.png
  wayword view map --platform matterport --data DATA --episodes REVERIE_val_seen.json --item 4634_215 --out path.svg

A path is drawn if one is asked for: with --seed, --hops, --metres or --episodes. The background shows the storey from above if
the platform has its geometry (house, habitat). In an SVG, hover over a viewpoint to see its name.")]
pub struct ViewMap {
    /// The platform.
    #[command(flatten)]
    pub platform: AskedPlatform,
    /// The path; none is drawn without one of these flags.
    #[command(flatten)]
    pub walk: ShownPathArgs,
    /// Number of the storey; the lowest is 1. [default: where the path starts, else the lowest]
    #[arg(long, value_name = "N")]
    pub level: Option<u32>,
    /// Map to write: .svg or .png.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
}

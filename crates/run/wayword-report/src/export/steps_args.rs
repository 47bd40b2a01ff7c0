//! The flags of `wayword export` for single actions and the layouts that are packed from them.

use clap::Args;
use std::path::PathBuf;

/// How walks are taken in single actions, and what the agent sees.
#[derive(Debug, Clone, Default, PartialEq, Args)]
#[command(next_help_heading = "With steps and layouts for training")]
pub struct AskedSteps {
    /// For a layout: the folder of --format steps that it is packed from. What it lacks is drawn and added, so several layouts share
    /// their pictures. [default: the folder steps of the run]
    #[arg(long, value_name = "DIR")]
    pub steps: Option<PathBuf>,
    /// Length of a step forward, metres. [default: 0.25, as in VLN-CE]
    #[arg(long, value_name = "METRES")]
    pub forward_m: Option<f64>,
    /// Angle of a turn, degrees. [default: 15, as in VLN-CE]
    #[arg(long, value_name = "DEGREES")]
    pub turn_deg: Option<f64>,
    /// How far a step may end off the walk, metres. [default: 0.25]
    #[arg(long, value_name = "METRES")]
    pub tolerance_m: Option<f64>,
    /// Size of the pictures. [default: 224x224]
    #[arg(long, value_name = "WIDTHxHEIGHT")]
    pub size_px: Option<String>,
    /// Horizontal field of view, degrees. [default: 90]
    #[arg(long, value_name = "DEGREES")]
    pub fov_deg: Option<f64>,
    /// A camera: its height over the agent's place in metres, and its pitch in degrees, as in 1.25,-30. May be given several times.
    /// [default: 1.25,0; for internnav also 1.25,-30]
    #[arg(long, value_name = "HEIGHT,PITCH")]
    pub camera: Vec<String>,
    /// With steps: write the pictures of so many walks into one tar file, as WebDataset reads them. [default: a folder for each walk]
    #[arg(long, value_name = "WALKS")]
    pub shard: Option<usize>,
}

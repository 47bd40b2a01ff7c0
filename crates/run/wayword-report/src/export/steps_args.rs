//! The flags of `wayword export --format steps`.

use clap::Args;

/// How walks are taken in single actions, and what the agent sees.
#[derive(Debug, Clone, Default, PartialEq, Args)]
#[command(next_help_heading = "With --format steps")]
pub struct AskedSteps {
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
    /// Height of the camera over the floor, metres. [default: 1.5]
    #[arg(long, value_name = "METRES")]
    pub eye_m: Option<f64>,
    /// Write the pictures of so many walks into one tar file, as WebDataset reads them. [default: a folder for each walk]
    #[arg(long, value_name = "WALKS")]
    pub shard: Option<usize>,
}

//! `wayword check` as the user types it.

use crate::{
    lookout::NO_PROPOSALS,
    settings::{AskedPlatform, AskedRoles, AskedSettings, EvidenceSources, Service, Writing},
    styles,
};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `wayword check`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword check REVERIE_val_seen.json --platform matterport --data DATA --style reverie
  wayword check R2R_val_seen.json --platform matterport --data DATA --style r2r --json
  wayword check runs/houses/instructions.jsonl --platform house --style r2r
  wayword check edited.json --run runs/houses")]
pub struct CheckArgs {
    /// File of instructions: R2R, REVERIE, RxR, VLN-CE or Wayword.
    pub file: PathBuf,
    /// The platform.
    #[command(flatten)]
    pub platform: AskedPlatform,
    /// Check against what this run saw, for texts of a run that were edited after `wayword export`: the labels of its platform if they
    /// were its evidence, or else the captions in its folder. If the platform cannot be opened, the captions are all that is left, and
    /// claims that they lack are unverified.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["platform", "data", "at", "island", "connectivity", "calibration"])]
    pub run: Option<PathBuf>,
    /// Check that every text keeps to this style. Without it, a text written by Wayword is checked against the built-in style that
    /// it was written in, and any other text only against its path.
    #[arg(long, value_name = "STYLE", value_parser = styles::check_style_name)]
    pub style: Option<String>,
    /// In a closed world, a claim that the evidence does not show is wrong. In an open one, it counts only if the evidence would
    /// have shown it.
    #[arg(long, value_name = "WORLD", value_enum, default_value_t)]
    pub world: AskedWorld,
    /// Let a text fail although another text about the same path makes the same claim.
    #[arg(long)]
    pub no_witnesses: bool,
    /// Do not follow the texts: no check of where they lead, of their turns in an open world, and of how many places they
    /// may mean.
    #[arg(long)]
    pub no_route: bool,
    /// Let a text fail that may mean several places, or several objects at the end of its path.
    #[arg(long, conflicts_with = "no_route")]
    pub reject_ambiguous: bool,
    /// Shares by the names of objects and rooms that `wayword calibrate` made.
    #[arg(long, value_name = "FILE")]
    pub calibration: Option<PathBuf>,
    /// Say of each text which words a reader should doubt, with up to three alternatives: `doubted` of --json.
    #[arg(long, conflicts_with = "run")]
    pub doubts: bool,
    /// A detector that looks for what the texts name.
    #[command(flatten)]
    pub detecting: CheckDetectorArgs,
    /// Show at most this many of the instructions that did not pass.
    #[arg(long, value_name = "N", default_value_t = 10)]
    pub show: usize,
}

/// The detector of `wayword check`.
#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Detector")]
pub struct CheckDetectorArgs {
    /// Look for the things that the texts name in the pictures along their paths, where the platform has no labels: a model as
    /// hf/ORG/NAME, which runs inside this program.
    #[arg(long, value_name = "MODEL", conflicts_with = "run")]
    pub detector: Option<String>,
    /// What `wayword perceive --detector` measured of it. Without it a thing that it misses is not taken to be absent.
    #[arg(long, value_name = "FILE", requires = "detector")]
    pub detector_figures: Option<PathBuf>,
    /// The evidence that counts: labels, detector, or both separated by a comma (the detector where there are no labels).
    /// [default: labels,detector]
    #[arg(long, value_name = "SOURCES", requires = "detector")]
    pub evidence: Option<EvidenceSources>,
    /// Device that it runs on: cpu, cuda, cuda:1 or metal. [default: cpu]
    #[arg(long, value_name = "DEVICE", requires = "detector")]
    pub device: Option<String>,
    /// Limit of the memory that it takes, in GiB. [default: the free memory of the machine]
    #[arg(long, value_name = "GIB", requires = "detector")]
    pub memory_gib: Option<f64>,
    /// SHA-256 that a checkpoint file (.pth) has to have, where its makers published none that is known here. Without it, that
    /// of the first use is kept, and later ones must equal it.
    #[arg(long, value_name = "SHA256", requires = "detector")]
    pub trust: Option<String>,
    /// File of the ledger, which keeps what it found. [default: wayword/ledger.db in the data folder of your system]
    #[arg(long, value_name = "FILE", requires = "detector")]
    pub ledger: Option<PathBuf>,
}

impl CheckDetectorArgs {
    /// These flags as the settings of other commands, without proposals: the detector looks only for things that texts name.
    #[must_use]
    pub fn to_asked(&self) -> AskedSettings {
        AskedSettings {
            roles: AskedRoles { detector: self.detector.clone(), ..AskedRoles::default() },
            writing: Writing {
                detector_figures: self.detector_figures.clone(),
                proposals: Some(NO_PROPOSALS.into()),
                ..Writing::default()
            },
            service: Service {
                device: self.device.clone(),
                memory_gib: self.memory_gib,
                trust: self.trust.clone(),
                ledger: self.ledger.clone(),
                ..Service::default()
            },
            ..AskedSettings::default()
        }
    }
}

/// The world in which texts are checked, as the user asks for it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum AskedWorld {
    /// Closed for texts that were written from the evidence at hand, open for all others.
    #[default]
    Auto,
    /// Open for all texts.
    Open,
    /// Closed for all texts.
    Closed,
}

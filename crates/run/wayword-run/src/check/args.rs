//! `wayword check` as the user types it.

use crate::{
    lookout::NO_PROPOSALS,
    pairs::args::PairArgs,
    settings::{AskedPlatform, AskedRoles, AskedSettings, EvidenceSources, Service, Writing},
    styles,
};
use clap::{Args, ValueEnum};
use std::{path::PathBuf, str::FromStr};

/// `wayword check`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword check REVERIE_val_seen.json --platform matterport --data DATA --style reverie
  wayword check R2R_val_seen.json --platform matterport --data DATA --style r2r --json
  wayword check runs/houses/instructions.jsonl --platform house --style r2r
  wayword check R2R_val_seen.json --platform matterport --data DATA --show fail
  wayword check edited.json --run runs/houses
  wayword check STREAMVLN_FOLDER --by pictures --see openai/gpt-4.1-mini --max-usd 5 --out pairs
      How likely each text is wrong about its film, the worst first, with a page to accept or reject them by keys.
  wayword check LEROBOT_DATASET --by pictures --detector hf/google/owlv2-base-patch16-ensemble --out pairs
  wayword check train.json.gz --by pictures --platform recording --data FRAMES --see ollama/llava --out pairs
      Frames of VLN-CE\'s episodes: a folder for each, with the name of the episode.")]
pub struct CheckArgs {
    /// File of instructions: R2R, REVERIE, RxR, VLN-CE or Wayword; or a folder of training data, as docs/FORMATS.md lists them.
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
    /// Pairs of pictures and texts.
    #[command(flatten)]
    pub pairs: PairArgs,
    /// Which of the instructions that did not pass are shown, those that failed first: at most N, fail (each that failed) or all.
    #[arg(long, value_name = "N|fail|all", default_value = "10")]
    pub show: ShownTexts,
}

/// The detector of `wayword check`.
#[derive(Debug, Default, Args)]
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
    #[arg(long, value_name = "SOURCES", conflicts_with = "run")]
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
    /// File of the ledger, which keeps what it found, and what the model of --see answered. [default: wayword/ledger.db in the data folder
    /// of your system]
    #[arg(long, value_name = "FILE")]
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

/// Which of the texts that did not pass are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShownTexts {
    /// At most so many.
    Most(usize),
    /// Each that failed.
    Failed,
    /// Each that failed or is unverified.
    All,
}

impl ShownTexts {
    /// How many of the texts that failed and of those that are unverified are shown.
    #[must_use]
    pub fn how_many(self, failed: usize, unverified: usize) -> [usize; 2] {
        match self {
            Self::Most(most) => [failed.min(most), unverified.min(most.saturating_sub(failed))],
            Self::Failed => [failed, 0],
            Self::All => [failed, unverified],
        }
    }
}

impl FromStr for ShownTexts {
    type Err = &'static str;

    fn from_str(typed: &str) -> Result<Self, Self::Err> {
        match typed {
            "fail" | "failed" => Ok(Self::Failed),
            "all" => Ok(Self::All),
            number => number.parse().map(Self::Most).map_err(|_| "give a number, fail or all"),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_that_failed_are_shown_before_those_that_are_unverified() {
        let how_many = |typed: &str| typed.parse::<ShownTexts>().unwrap().how_many(3, 5);
        assert_eq!([how_many("0"), how_many("2"), how_many("4"), how_many("99")], [[0, 0], [2, 0], [3, 1], [3, 5]]);
        assert_eq!([how_many("fail"), how_many("all")], [[3, 0], [3, 5]]);
        assert!("some".parse::<ShownTexts>().is_err() && "-1".parse::<ShownTexts>().is_err());
    }
}

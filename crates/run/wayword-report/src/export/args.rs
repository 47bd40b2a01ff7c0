//! The command line of `wayword export`: its flags, and the formats that it can write.

use crate::export::steps_args::AskedSteps;
use clap::{Args, ValueEnum};
use std::{
    fmt,
    path::{Path, PathBuf},
};
use wayword_formats::DatasetFormat;
use wayword_run::settings::AskedPlatform;
use wayword_run::{check::args::AskedWorld, error::CommandError};

/// The format of an export.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ExportFormat {
    /// A file of R2R's format.
    R2r,
    /// A file of REVERIE's.
    Reverie,
    /// A file of RxR's.
    Rxr,
    /// A file of VLN-CE's.
    Vlnce,
    /// A file of Wayword's own records.
    Wayword,
    /// The files that VLN-DUET and VLN-HAMT load, with the ids of the tokens.
    Duet,
    /// One table.
    Parquet,
    /// A folder with tables and a dataset card.
    Hf,
    /// A folder of trajectories: single actions, with what cameras see before each.
    Steps,
    /// StreamVLN's trajectory data.
    Streamvln,
    /// InternNav's VLN-CE walks with pixel goals.
    Internnav,
    /// InternData's VLN-N1.
    InternnavN1,
    /// NaVILA's decisions, and its videos for speakers.
    Navila,
    /// Uni-NaVid's and NaVid's conversations about videos.
    Uninavid,
    /// A folder with RxR-CE's episodes and actions.
    Rxrce,
    /// The lines from which VLN-DUET and ScaleVLN pre-train.
    DuetPretrain,
    /// A LeRobot dataset with columns of language.
    Lerobot,
}

impl ExportFormat {
    /// The format of the single file that is written, which the program can also read; `None` for formats of several files.
    #[must_use]
    pub fn file_format(self) -> Option<DatasetFormat> {
        match self {
            Self::R2r => Some(DatasetFormat::R2r),
            Self::Reverie => Some(DatasetFormat::Reverie),
            Self::Rxr => Some(DatasetFormat::Rxr),
            Self::Vlnce => Some(DatasetFormat::Vlnce),
            Self::Wayword => Some(DatasetFormat::Wayword),
            _ => None,
        }
    }

    /// Whether it takes several runs.
    #[must_use]
    pub fn takes_several_runs(self) -> bool {
        matches!(self, Self::Wayword | Self::Parquet | Self::Hf)
    }

    /// Whether it takes texts of several styles.
    #[must_use]
    pub fn takes_all_styles(self) -> bool {
        self.takes_several_runs() || self == Self::Steps || self.is_layout()
    }

    /// Whether it is a layout for training that is packed from steps.
    #[must_use]
    pub fn is_layout(self) -> bool {
        matches!(
            self,
            Self::Streamvln | Self::Internnav | Self::InternnavN1 | Self::Navila | Self::Uninavid | Self::Lerobot
        )
    }

    /// Whether it is a folder.
    #[must_use]
    pub fn is_folder(self) -> bool {
        matches!(self, Self::Duet | Self::Hf | Self::Steps | Self::Rxrce | Self::DuetPretrain) || self.is_layout()
    }

    /// Whether the written files name the split of each text.
    #[must_use]
    pub fn names_splits(self) -> bool {
        matches!(self, Self::Rxr | Self::Parquet) || self.is_folder()
    }
}

impl fmt::Display for ExportFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.to_possible_value();
        f.write_str(name.as_ref().map_or("", |name| name.get_name()))
    }
}

/// A dataset; agents load files that are named and laid out as in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum AgentDataset {
    /// R2R_SPLIT_enc.json.
    R2r,
    /// REVERIE_SPLIT_enc.json.
    Reverie,
    /// rxr_SPLIT_guide_enc_xlmr.jsonl.
    Rxr,
}

impl ExportArgs {
    /// The run, for a format that takes one.
    ///
    /// # Errors
    /// When there is none, or more than one.
    pub(super) fn only_run(&self) -> Result<&Path, CommandError> {
        match self.run.as_slice() {
            [run] => Ok(run),
            _ => Err(CommandError::usage("this format takes one run", "give --run once")),
        }
    }
}

/// `wayword export`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword export --run runs/val_seen --style reverie --format reverie --out val_seen_generated.json
  wayword export --run runs/a --run runs/b --format wayword --val-share 0.1 --out merged.jsonl
  wayword export --run runs/val_seen --style r2r --format duet --tokenizer hf/google-bert/bert-base-uncased --out annotations
  wayword export --run runs/houses --format hf --out published      (a folder that Python's datasets reads)
  wayword export --run runs/houses --format parquet --out houses.parquet
  wayword export --run runs/houses --format steps --out train        (VLN-CE's actions, with a picture before each)
  wayword export --run runs/houses --format steps --shard 100 --size-px 640x480 --out shards
  wayword export --run runs/houses --format streamvln --out streamvln      (layouts share the pictures in runs/houses/steps)
  wayword export --run runs/houses --format lerobot --out lerobot
  wayword export --run runs/val_seen --style r2r --highlight doubts
  wayword export --pairs STREAMVLN_FOLDER --decisions decisions.jsonl --out accepted.json
  wayword export --texts R2R_val_seen.json --platform matterport --data DATA --highlight doubts")]
pub struct ExportArgs {
    /// Run folder. Several can be merged in the formats wayword, parquet and hf.
    #[arg(long, value_name = "DIR")]
    pub run: Vec<PathBuf>,
    /// Export only the instructions of this style; required for a run of several styles and the formats that are one dataset's or
    /// agent's: r2r, reverie, rxr, vlnce, rxrce, duet and duet-pretrain.
    #[arg(long, value_name = "STYLE")]
    pub style: Option<String>,
    /// Instead of a dataset, write NAME.html and NAME.json: the texts with the words that a reader should doubt, and up to three
    /// alternatives for each. docs/CHECKS.md explains which words these are.
    #[arg(long, value_name = "NAME")]
    pub highlight: Option<PathBuf>,
    /// With --highlight: the texts of this file instead of a run's: R2R, REVERIE, RxR, VLN-CE or Wayword.
    #[arg(long, value_name = "FILE")]
    pub texts: Option<PathBuf>,
    /// The platform of --texts. A run knows its own.
    #[command(flatten)]
    pub platform: AskedPlatform,
    /// With --highlight: the world in which the texts are checked. Other words are offered in an open world alone.
    #[arg(long, value_name = "WORLD", value_enum, default_value_t)]
    pub world: AskedWorld,
    /// Format: r2r, reverie, rxr, vlnce, wayword; duet, the files of VLN-DUET and VLN-HAMT with the ids of tokens; parquet, a table;
    /// hf, a folder with tables and a dataset card, made for publishing; steps, a folder of single actions with what cameras see
    /// before each; and what training code reads: streamvln, internnav, internnav-n1, navila, uninavid, lerobot, rxrce (VLN-CE for RxR) and
    /// duet-pretrain.
    #[arg(long, value_enum, hide_possible_values = true)]
    pub format: Option<ExportFormat>,
    /// File to write; for duet, hf, steps and what training code reads a folder. Where a format's loaders refuse unknown fields, the provenance goes into a second
    /// file beside it.
    #[arg(long, value_name = "PATH")]
    pub out: Option<PathBuf>,
    /// With duet and duet-pretrain: the agent's tokenizer, a tokenizer.json or the model that has it, such as hf/google-bert/bert-base-uncased
    /// (R2R, REVERIE) or hf/FacebookAI/xlm-roberta-base (RxR).
    #[arg(long, value_name = "FILE|MODEL")]
    pub tokenizer: Option<String>,
    /// With duet and duet-pretrain: the dataset of the agent's files. [default: the one that the style is named after; else reverie if the texts name
    /// targets; else r2r]
    #[arg(long, value_enum)]
    pub dataset: Option<AgentDataset>,
    /// The split of all texts. A scene of an official val_unseen or test split goes into no other. [default: the split of the run's
    /// episodes; else the official split of the scene; else train]
    #[arg(long, value_name = "NAME")]
    pub split: Option<String>,
    /// What curators decided on the page of `wayword check --by pictures`: what they rejected is left out. May be given several times; of
    /// several decisions about one pair the latest counts.
    #[arg(long, value_name = "FILE")]
    pub decisions: Vec<PathBuf>,
    /// Instead of a run, write this dataset again without what --decisions rejects: StreamVLN, NaVILA, InternNav, R2R, REVERIE or RxR.
    #[arg(long, value_name = "DATASET", requires = "decisions", conflicts_with_all = ["run", "highlight", "format"])]
    pub pairs: Option<PathBuf>,
    /// With hf: confirm that you may publish texts about the scenes of this platform. Every platform but house needs it: its scenes are
    /// somebody's.
    #[arg(long)]
    pub i_have_the_right: bool,
    /// Put this share of the scenes into a val split. No scene is in both splits, and none that is officially held out is in train.
    #[arg(long, value_name = "SHARE")]
    pub val_share: Option<f64>,
    /// Seed of the choice of val scenes.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// How walks are taken in single actions.
    #[command(flatten)]
    pub steps: AskedSteps,
}

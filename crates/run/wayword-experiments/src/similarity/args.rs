//! The command line of `wayword similarity`.

use crate::by_pictures::args::PictureCriticArgs;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `wayword similarity`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword similarity runs/val_seen#reverie REVERIE_val_seen.json
      How similar a run is to what people wrote, next to how similar two people are, and to chance.
  wayword similarity runs/a runs/b --style r2r --json
  wayword similarity runs/val_seen#r2r R2R_val_seen.json --by path
      Compare texts of different datasets that describe the same paths.
  wayword similarity runs/a runs/b --style r2r --encoder words      (counts words, needs no model)
  wayword similarity runs/val_seen#r2r R2R_val_seen.json --by path --metrics
      BLEU, ROUGE-L and CIDEr-D as papers print them, beside another person's text and another path's text.
  wayword similarity runs/val_seen#r2r R2R_val_seen.json --by path --metrics --clip hf/openai/clip-vit-base-patch32
      The same, and how well the texts agree with the run's pictures.")]
pub struct SimilarityArgs {
    /// Instructions: a run folder, or a file in R2R, REVERIE, RxR, VLN-CE or Wayword format. Add #STYLE to take one style.
    #[arg(value_name = "A")]
    pub a: String,
    /// The instructions to compare with, named the same way. For comparison, the program also measures
    /// pairs of people's texts for one item, and random pairs, within these.
    #[arg(value_name = "B")]
    pub b: String,
    /// Compare texts of the same item, or of the same path.
    #[arg(long, default_value = "item")]
    pub by: TextPairing,
    /// Sentence encoder as hf/ORG/NAME, or `words` to count words without a model.
    #[arg(long, value_name = "MODEL", default_value = "hf/sentence-transformers/all-MiniLM-L6-v2")]
    pub encoder: String,
    /// Use only this style of runs and Wayword files.
    #[arg(long, value_name = "STYLE")]
    pub style: Option<String>,
    /// Print BLEU-1 to BLEU-4, ROUGE-L and CIDEr-D of A's texts against B's in place of a cosine, and how diverse the
    /// texts of both are. Needs no model.
    #[arg(long)]
    pub metrics: bool,
    /// Tokens of the metrics: `ptb` as pycocoevalcap makes them, `split` as the speakers of R2R do (lower case, words and
    /// marks apart), or `characters`, the default for Chinese and Japanese.
    #[arg(long, requires = "metrics")]
    pub tokens: Option<MetricTokens>,
    /// Cut texts off after so many characters before the metrics, on both sides, as some papers do.
    #[arg(long, value_name = "N", requires = "metrics", value_parser = clap::value_parser!(u32).range(1..))]
    pub truncate_characters: Option<u32>,
    /// Run METEOR, too: meteor-1.5.jar, which the program does not bring.
    #[arg(long, value_name = "FILE", requires = "metrics")]
    pub meteor_jar: Option<PathBuf>,
    /// Run SPICE, too: spice-1.0.jar with its models. Unverified, because we could not get its models.
    #[arg(long, value_name = "FILE", requires = "metrics")]
    pub spice_jar: Option<PathBuf>,
    /// The Java that runs them.
    #[arg(long, value_name = "PROGRAM", default_value = "java", requires = "metrics")]
    pub java: PathBuf,
    /// The pictures that the metrics hold texts against.
    #[command(flatten)]
    pub pictured: PictureCriticArgs,
    /// Number of bootstrap resamples for the intervals.
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(100..=100_000))]
    pub resamples: u32,
    /// Seed of the intervals and of the random pairs.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
}

/// What two texts have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TextPairing {
    /// The item: its id.
    Item,
    /// The path: its scene and path id. The target may differ.
    Path,
}

/// How texts become tokens.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MetricTokens {
    /// As Stanford's `PTBTokenizer` in pycocoevalcap.
    Ptb,
    /// As the speakers of R2R.
    Split,
    /// Each Chinese or Japanese character by itself, and the rest as `split`.
    Characters,
}

impl MetricTokens {
    /// The tokens for texts of a language that are taken unless others are asked for.
    #[must_use]
    pub fn for_language(language: &str) -> Self {
        if matches!(language, "Chinese" | "Japanese") { Self::Characters } else { Self::Ptb }
    }

    /// Its name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ptb => "ptb",
            Self::Split => "split",
            Self::Characters => "characters",
        }
    }
}

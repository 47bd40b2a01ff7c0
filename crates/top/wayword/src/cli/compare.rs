//! `wayword compare` as it is typed.

use crate::settings::{Asked, AskedRoles, Draw, RULES, Service, Walks, World, is_mind};
use clap::{Args, ValueEnum, builder::PossibleValuesParser};
use std::path::PathBuf;
use wayword_metrics::Rule;
use wayword_navigation::swap::Swap;

/// `wayword compare`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword compare --platform matterport --data DATA --episodes REVERIE_val_seen.json --out runs/table \\
      --instructions original --instructions central=runs/central#reverie --instructions panoramic=runs/panoramic#reverie
      Three agents walk by what people wrote and by what two runs wrote; labels stand in for photographs.
  wayword compare --episodes runs/houses/instructions.jsonl --grounder labels/lexical --out runs/houses_walked
      Generated houses and their own instructions, without any model.
  wayword compare --platform matterport --data DATA --episodes R2R_val_seen.json --agents clip-nav \\
      --grounder hf/openai/clip-vit-base-patch32 --out runs/clip      (needs photographs, and the feature full)
  wayword compare --platform matterport --data DATA --episodes REVERIE_val_seen.json --split ollama/qwen3 --out runs/split
      A language model takes the instructions apart, and not rules.

The same command again goes on where it was stopped. `wayword report --run runs/table` shows the walks on the map.")]
pub struct Compare {
    /// Where to put walks, tables and the page; the same command again continues it.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// The world.
    #[command(flatten)]
    pub world: World,
    /// The items: a dataset file in R2R, REVERIE, RxR or Wayword format.
    #[arg(long, value_name = "FILE")]
    pub episodes: PathBuf,
    /// A set of instructions: original (the episodes' own), or NAME=RUN#STYLE, NAME=FILE; may be given several times. The first is
    /// what the others are held against. [default: original]
    #[arg(long, value_name = "SET")]
    pub instructions: Vec<String>,
    /// Who walks: clip-nav, seq-clip-nav, glip-nav. Floors and ceilings walk beside them.
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        default_value = "clip-nav,seq-clip-nav,glip-nav",
        value_parser = PossibleValuesParser::new(AGENTS),
        hide_possible_values = true
    )]
    pub agents: Vec<String>,
    /// Who says how well phrases fit views: labels/lexical (by words, no weights), labels (with a text encoder), or a CLIP as
    /// hf/ORG/NAME.
    #[arg(long, value_name = "GROUNDER", default_value = "labels/lexical")]
    pub grounder: String,
    /// The sentence encoder of `labels`.
    #[arg(long, value_name = "MODEL", default_value = "hf/sentence-transformers/all-MiniLM-L6-v2")]
    pub encoder: String,
    /// Who takes instructions apart: rules, or a language model as provider/model.
    #[arg(long, value_name = "MODEL", default_value = "rules", value_parser = splitter)]
    pub split: String,
    /// Base URL of the provider of --split.
    #[arg(long, value_name = "URL")]
    pub base_url: Option<String>,
    /// Success: the target is visible from the last viewpoint (REVERIE's official rule), or the goal is under 3 m away. [default:
    /// visible where every item names an object, else distance]
    #[arg(long)]
    pub rule: Option<SuccessRule>,
    /// How the first set's instructions are swapped to see whether agents listen; `none` for no swaps.
    #[arg(
        long,
        value_name = "SWAPS",
        value_delimiter = ',',
        default_value = "directions,landmarks,sentences,other-path"
    )]
    pub swaps: Vec<SwapName>,
    /// What agents decide by, as TOML: a table per agent, with the names that the page shows.
    #[arg(long, value_name = "FILE")]
    pub parameters: Option<PathBuf>,
    /// Only the first so many items.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub limit: Option<u32>,
    /// Resamples of the intervals.
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(100..=100_000))]
    pub resamples: u32,
    /// Seed of everything random.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Replays on the page.
    #[arg(long, value_name = "N", default_value_t = 24)]
    pub replays: usize,
    /// Settings as TOML, with the providers of `generate`.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// How models are reached.
    #[command(flatten)]
    pub service: Service,
}

/// Who can walk by an instruction, as `--agents` takes them.
const AGENTS: [&str; 3] = ["clip-nav", "seq-clip-nav", "glip-nav"];

/// Who takes instructions apart, as typed.
fn splitter(name: &str) -> Result<String, String> {
    if is_mind(name, RULES) {
        return Ok(name.to_owned());
    }
    Err(format!("name {RULES}, or a language model as provider/model, as in --split ollama/qwen3"))
}

impl Compare {
    /// What the flags ask for, as other commands have it. The splitter's model is the only one, in the place of the one who asks.
    #[must_use]
    pub fn asked(&self) -> Asked {
        Asked {
            world: self.world.clone(),
            walks: Walks { episodes: Some(self.episodes.clone()), ..Walks::default() },
            draw: Draw { seed: Some(self.seed), limit: self.limit.map(|limit| limit as usize) },
            roles: AskedRoles {
                ask: Some(self.split.clone()),
                base_url: self.base_url.clone(),
                ..AskedRoles::default()
            },
            service: self.service.clone(),
            ..Asked::default()
        }
    }
}

/// What counts as success, as typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SuccessRule {
    /// The last viewpoint lies under 3 m from the goal.
    Distance,
    /// The target is visible from the last viewpoint.
    Visible,
}

impl From<SuccessRule> for Rule {
    fn from(rule: SuccessRule) -> Self {
        match rule {
            SuccessRule::Distance => Self::Distance,
            SuccessRule::Visible => Self::Visible,
        }
    }
}

/// A way to swap, as typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SwapName {
    /// Left for right, up for down.
    Directions,
    /// Things and rooms for others.
    Landmarks,
    /// Sentences in another order.
    Sentences,
    /// The instruction of another path of the building.
    OtherPath,
    /// No swap.
    None,
}

impl SwapName {
    /// The swap; none for `none`.
    #[must_use]
    pub fn swap(self) -> Option<Swap> {
        match self {
            Self::Directions => Some(Swap::Directions),
            Self::Landmarks => Some(Swap::Landmarks),
            Self::Sentences => Some(Swap::Sentences),
            Self::OtherPath => Some(Swap::OtherPath),
            Self::None => None,
        }
    }
}

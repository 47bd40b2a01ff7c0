//! The command line of `wayword compare`.

use super::tool_agent_eyes::ToolAgentEyes;
use clap::{Args, ValueEnum, builder::PossibleValuesParser};
use std::{fmt, path::PathBuf, str::FromStr};
use wayword_metrics::TrajectorySuccessRule;
use wayword_navigation::{agents::WalkPrior, swap::InstructionSwap};
use wayword_run::settings::{AskedPlatform, AskedRoles, AskedSettings, Draw, RolePlayer, Service, Walks};

/// `wayword compare`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword compare --platform matterport --data DATA --episodes REVERIE_val_seen.json --out runs/table \\
      --instructions original --instructions central=runs/central#reverie --instructions panoramic=runs/panoramic#reverie
      Three agents follow what people wrote and what two runs wrote. Labels stand in for photographs.
  wayword compare --episodes runs/houses/instructions.jsonl --instructions houses=runs/houses#r2r --out runs/houses_walked
      Three agents follow a run's own instructions in generated houses, without any model.
  wayword compare --platform matterport --data DATA --episodes R2R_val_seen.json --agents clip-nav \\
      --grounder hf/openai/clip-vit-base-patch32 --out runs/clip      (needs photographs, and the feature full)
  wayword compare --platform matterport --data DATA --episodes R2R_val_seen.json --agents reader,reader-map --out runs/read
      Agents that read turns, rooms, landmarks and stairs: one finds its way, the other knows the map.
  wayword compare --platform matterport --data DATA --episodes REVERIE_val_seen.json --split ollama/qwen3 --out runs/split
      A language model splits the instructions into phrases, instead of rules.
  wayword compare --platform matterport --data DATA --episodes R2R_val_seen.json --limit 24 --instructions original \\
      --instructions ours=runs/val_seen#r2r --agents tools,reader --llm openai/gpt-4.1-mini --swaps none --dry-run --out runs/tools
      What it would cost to let a language model walk by the texts. Without --dry-run it walks.

Give the same command again to continue a comparison that was stopped. `wayword report --run runs/table` shows the walks on a map.")]
pub struct CompareArgs {
    /// Folder for walks, tables and the page. Give the same command again to continue.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// The platform.
    #[command(flatten)]
    pub platform: AskedPlatform,
    /// File of the items: R2R, REVERIE, RxR, VLN-CE or Wayword.
    #[arg(long, value_name = "FILE")]
    pub episodes: PathBuf,
    /// A set of instructions: `original` (those of the episodes' file), NAME=RUN#STYLE or NAME=FILE. Give the flag several times to
    /// compare sets; all are compared with the first. [default: original]
    #[arg(long, value_name = "SET")]
    pub instructions: Vec<String>,
    /// The agents: clip-nav, seq-clip-nav, glip-nav (walk by phrases), reader (reads every clause, and knows only where it was),
    /// reader-map (reads the same, and knows the map), tools (a language model that looks around and steps: --llm). Always added:
    /// random and straight (lower-bound baselines), nearest-room (knows the map) and oracle (upper bound).
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        default_value = "clip-nav,seq-clip-nav,glip-nav",
        value_parser = PossibleValuesParser::new(SELECTABLE_AGENTS),
        hide_possible_values = true
    )]
    pub agents: Vec<String>,
    /// What scores how well a phrase fits a view: labels/lexical (compares words, no weights), labels (with a text encoder), a CLIP
    /// model as hf/ORG/NAME, detector (that of --detector), or GLIP as hf/ORG/NAME:FILE.pth, which is then the detector too.
    /// glip-nav takes the boxes of --detector.
    #[arg(long, value_name = "GROUNDER", default_value = "labels/lexical")]
    pub grounder: String,
    /// Detector that finds things in pictures, as hf/ORG/NAME: a phrase scores as its best box does.
    #[arg(long, value_name = "MODEL")]
    pub detector: Option<String>,
    /// Sentence encoder of the grounder `labels`.
    #[arg(long, value_name = "MODEL", default_value = "hf/sentence-transformers/all-MiniLM-L6-v2")]
    pub encoder: String,
    /// Which walks reader-map thinks of: shortest:1-N (the shortest path to each viewpoint 1 to N hops away), or none (walks of two
    /// shortest pieces). [default: shortest:1-20]
    #[arg(long, value_name = "PRIOR")]
    pub prior: Option<AskedPrior>,
    /// What splits an instruction into phrases for the agents that walk by phrases: rules, or a language model as provider/model.
    #[arg(long, value_name = "MODEL", default_value = "rules", value_parser = parse_splitter)]
    pub split: RolePlayer,
    /// Language model of the agent `tools`, over HTTP, as provider/model. It calls tools where its provider has them.
    #[arg(long, value_name = "MODEL", value_parser = parse_walker_model)]
    pub llm: Option<String>,
    /// How the agent `tools` sees: labels (the platform's ground-truth labels, and the room), pictures (the model of --llm is shown
    /// them), or a model as provider/model that describes the pictures. [default: labels]
    #[arg(long, value_name = "HOW")]
    pub see: Option<ToolAgentEyes>,
    /// Longer side of the pictures that models get; larger pictures are shrunk. [default: 512]
    #[arg(long, value_name = "PX")]
    pub picture_px: Option<u32>,
    /// Base URL of the provider of --split, --llm and --see.
    #[arg(long, value_name = "URL")]
    pub base_url: Option<String>,
    /// What counts as success: the target is visible from the last viewpoint (REVERIE's rule), or the goal is less than 3 m away
    /// (R2R's rule). [default: visible if every item names an object, else distance]
    #[arg(long)]
    pub rule: Option<SuccessRule>,
    /// Swap tests: how the first set's instructions are made wrong, to see whether the agents follow them at all. `none` makes no
    /// swaps.
    #[arg(
        long,
        value_name = "SWAPS",
        value_delimiter = ',',
        default_value = "directions,landmarks,sentences,other-path"
    )]
    pub swaps: Vec<SwapName>,
    /// Thresholds and limits of the agents as TOML: one table per agent, with the names in docs/AGENTS.md.
    #[arg(long, value_name = "FILE")]
    pub parameters: Option<PathBuf>,
    /// Print what the models would be asked and what that would cost, and ask nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Refused with the reason, and so not listed: other commands take it, and no agent judges claims.
    #[arg(long, value_name = "FILE", hide = true)]
    pub calibration: Option<PathBuf>,
    /// Use only the first N items.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub limit: Option<u32>,
    /// Number of bootstrap resamples for the intervals.
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(100..=100_000))]
    pub resamples: u32,
    /// Seed of everything random.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Number of walks that the HTML page replays.
    #[arg(long, value_name = "N", default_value_t = 24)]
    pub replays: usize,
    /// Settings as TOML; only its tables `service` and `providers` are used.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// How models are reached.
    #[command(flatten)]
    pub service: Service,
}

/// The agents that `--agents` takes.
const SELECTABLE_AGENTS: [&str; 6] = ["clip-nav", "seq-clip-nav", "glip-nav", "reader", "reader-map", "tools"];

/// The walks that an agent that knows the map considers, as typed with `--prior`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AskedPrior(pub WalkPrior);

/// Most hops of a walk that an agent considers.
const MAX_PRIOR_HOPS: usize = 20;

impl Default for AskedPrior {
    /// All that can be asked for: viewpoints of a generated house stand so close that its paths have up to 20 hops.
    fn default() -> Self {
        Self(WalkPrior::Shortest(MAX_PRIOR_HOPS))
    }
}

/// Hops of the walks of two pieces.
const TWO_PIECE_PRIOR_HOPS: usize = 8;

impl fmt::Display for AskedPrior {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            WalkPrior::Shortest(hops) => write!(f, "shortest:1-{hops}"),
            WalkPrior::TwoPieces(_) => f.write_str("none"),
        }
    }
}

impl FromStr for AskedPrior {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let hops = typed.strip_prefix("shortest:1-").and_then(|hops| hops.parse().ok());
        match hops.filter(|hops| (1..=MAX_PRIOR_HOPS).contains(hops)) {
            Some(hops) => Ok(Self(WalkPrior::Shortest(hops))),
            None if typed == "none" => Ok(Self(WalkPrior::TwoPieces(TWO_PIECE_PRIOR_HOPS))),
            None => Err(format!("give shortest:1-N with N from 1 to {MAX_PRIOR_HOPS}, or none")),
        }
    }
}

/// Checks the value of `--split`.
fn parse_splitter(name: &str) -> Result<RolePlayer, String> {
    let problem = "name rules, or a language model as provider/model, as in --split ollama/qwen3";
    RolePlayer::Rules.or_model(name).ok_or_else(|| problem.to_owned())
}

/// Checks the value of `--llm`.
fn parse_walker_model(name: &str) -> Result<String, String> {
    match name.parse::<RolePlayer>() {
        Ok(player) if player.remote_model().is_some() => Ok(name.to_owned()),
        _ => Err("name a language model behind HTTP as provider/model, as in --llm openai/gpt-4.1-mini".to_owned()),
    }
}

impl CompareArgs {
    /// The detector: that of `--detector`, or a grounder that is a checkpoint of GLIP (`hf/ORG/NAME:FILE.pth`).
    #[must_use]
    pub fn detector_name(&self) -> Option<&str> {
        let is_glip = |name: &&str| name.starts_with("hf/") && name.ends_with(".pth");
        self.detector.as_deref().or_else(|| Some(self.grounder.as_str()).filter(is_glip))
    }

    /// The flags in the form from which all commands make their settings. The splitter's model fills the role that asks, and the
    /// model of the agent `tools` fills the role that writes.
    #[must_use]
    pub fn asked_settings(&self) -> AskedSettings {
        AskedSettings {
            platform: self.platform.clone(),
            walks: Walks { episodes: Some(self.episodes.clone()), ..Walks::default() },
            draw: Draw { seed: Some(self.seed), limit: self.limit.map(|limit| limit as usize) },
            roles: AskedRoles {
                ask: Some(self.split.to_string()),
                see: self.see.as_ref().filter(|see| **see != ToolAgentEyes::Pictures).map(ToString::to_string),
                write: self.llm.clone(),
                write_sees: (self.see == Some(ToolAgentEyes::Pictures)).then_some(true),
                picture_px: self.picture_px,
                base_url: self.base_url.clone(),
                detector: self.detector_name().map(str::to_owned),
                ..AskedRoles::default()
            },
            service: self.service.clone(),
            ..AskedSettings::default()
        }
    }
}

/// What counts as success, as typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SuccessRule {
    /// The last viewpoint is less than 3 m from the goal.
    Distance,
    /// The target is visible from the last viewpoint.
    Visible,
}

impl From<SuccessRule> for TrajectorySuccessRule {
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
    /// Other objects and rooms instead of those that are named.
    Landmarks,
    /// Sentences in another order.
    Sentences,
    /// The instruction of another path in the same building.
    OtherPath,
    /// No swap.
    None,
}

impl SwapName {
    /// The swap; none for `none`.
    #[must_use]
    pub fn to_swap(self) -> Option<InstructionSwap> {
        match self {
            Self::Directions => Some(InstructionSwap::Directions),
            Self::Landmarks => Some(InstructionSwap::Landmarks),
            Self::Sentences => Some(InstructionSwap::Sentences),
            Self::OtherPath => Some(InstructionSwap::OtherPath),
            Self::None => None,
        }
    }
}

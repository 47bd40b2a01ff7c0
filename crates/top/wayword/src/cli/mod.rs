//! The command line as it is typed.

mod compare;
mod doctor;
mod evaluate;
mod ledger;
mod models;
mod perceive;
mod similarity;
mod view;

use crate::settings::{Against, Asked, AskedRoles, Perception, Service, TargetMode};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;
use wayword_synthesis::walk::FrameSelection;

pub use compare::{Compare, SuccessRule, SwapName};
pub use doctor::Doctor;
pub use evaluate::Evaluate;
pub use ledger::{Ledger, LedgerCommand};
pub use models::{Models, ModelsCommand};
pub use perceive::Perceive;
pub use similarity::{By, Similarity};
pub use view::{View, ViewCommand, ViewMap, ViewPanorama, ViewPath, Walk};

/// Writes the wayfinding instructions that a person would give a robot, for any simulator, and checks them.
#[derive(Debug, Parser)]
#[command(version, after_long_help = EXAMPLES)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Data as JSON on standard output.
    #[arg(long, global = true)]
    pub json: bool,
    /// No talk and no progress on standard error.
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  wayword demo
      A walk through a generated house, instructions for it in two styles, and report.html.
  wayword generate --platform house --paths 20 --style r2r --out runs/houses
      Instructions for 20 random paths through generated houses.
  wayword generate --platform matterport --data DATA --episodes REVERIE_val_seen.json --style reverie --out runs/val_seen
      Instructions for every path of a dataset. The same command again continues a run that was stopped.
  wayword generate --paths 20 --style r2r --llm ollama/qwen3 --see ollama/llava --out runs/models
      The same with models: one asks, sums up and writes, the other looks at the pictures.
  wayword export --run runs/val_seen --style reverie --format reverie --out val_seen_generated.json
      The run in the file format that agents read.
  wayword check REVERIE_val_seen.json --platform matterport --data DATA --style reverie
      Anyone's instructions, held against the evidence of their paths.
  wayword evaluate submission.json --episodes REVERIE_val_seen.json --platform matterport --data DATA
      Anyone's trajectories, scored as the official evaluators do, with intervals.

Exit codes:
  0  done, and every check passed
  1  the input was wrong, or a file could not be read or written
  2  the command line could not be read
  3  done, but some instructions were rejected or failed a check; each with its reason
  4  another process works in the same run folder
  5  stopped before the end: a budget was spent, a key was refused, or you interrupted; the same command goes on";

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Walk through a generated house and write instructions for the walk, offline.
    Demo(Demo),
    /// Write instructions for paths, check them, and repair or reject what fails.
    Generate(Box<Generate>),
    /// Check instructions of anyone's against the evidence of their paths.
    Check(Check),
    /// Write a run in the file format that agents read.
    Export(Export),
    /// Write a run as one HTML page: map, frames, dialogue, captions, instructions and checks.
    Report(Report),
    /// Measure how well captions fit the labels of their views: objects, ghosts, calls.
    Perceive(Box<Perceive>),
    /// Measure how alike two sets of instructions are, beside what people and chance reach.
    Similarity(Similarity),
    /// Let agents walk by sets of instructions, and hold the sets against each other.
    Compare(Box<Compare>),
    /// Score anyone's trajectories as the evaluators of R2R and REVERIE do, with intervals.
    Evaluate(Evaluate),
    /// Check keys, endpoints, models and data, and say what to do.
    Doctor(Box<Doctor>),
    /// What was asked of models, what it cost, and what is kept.
    Ledger(Ledger),
    /// Models that run in this program: what is on this machine, and how to get more.
    Models(Models),
    /// The worlds that there are: what each needs and offers.
    Platforms,
    /// Pictures of a world: a panorama, a path as its walker sees it, a map.
    View(View),
    /// Save a generated house as glTF with its navigation data, and as a scene of AI Habitat with semantics.
    House(House),
    /// Print shell completions.
    Completions {
        /// For which shell.
        shell: clap_complete::Shell,
    },
}

/// `wayword demo`.
#[derive(Debug, Args)]
#[command(after_long_help = "Examples:\n  wayword demo\n  wayword demo --seed 7 --out walk")]
pub struct Demo {
    /// Which house, and which walk through it.
    #[arg(long, default_value_t = 3)]
    pub seed: u64,
    /// Where to put the run and its report.
    #[arg(long, default_value = "wayword-demo")]
    pub out: PathBuf,
}

/// Which world, and where its data lies.
#[derive(Debug, Clone, Default, Args)]
pub struct World {
    /// The world: house (generated, built in), matterport, habitat, tdw, virtualhome, process or recording; `wayword platforms`
    /// lists what each needs. [default: house]
    #[arg(long)]
    pub platform: Option<String>,
    /// Folder or file of the world's data.
    #[arg(long, value_name = "PATH")]
    pub data: Option<PathBuf>,
    /// Address of a world that runs: HOST:PORT for tdw, a URL for virtualhome.
    #[arg(long, value_name = "ADDRESS")]
    pub at: Option<String>,
}

impl World {
    /// What the flags ask for, and nothing else.
    #[must_use]
    pub fn asked(&self) -> Asked {
        Asked { platform: self.platform.clone(), data: self.data.clone(), at: self.at.clone(), ..Asked::default() }
    }

    /// Its name, where no settings but these flags give it.
    #[must_use]
    pub fn name(&self) -> &str {
        self.platform.as_deref().unwrap_or("house")
    }
}

/// `wayword generate`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword generate --paths 20 --out runs/houses
  wayword generate --platform matterport --data DATA --paths 200 --hops 4..7 --metres 5..20 --seed 1 --out runs/random
  wayword generate --platform matterport --data DATA --episodes REVERIE_val_seen.json --style reverie --style r2r --out runs/val_seen
  wayword generate --style mine.toml --style r2r=R2R_train.json --out runs/styles
  wayword generate --paths 20 --llm ollama/qwen3 --see ollama/llava --out runs/models
  wayword generate --paths 20 --llm openai/gpt-4.1-mini --see openai/gpt-4.1-mini --max-usd 2 --dry-run
  wayword generate --config run.toml --seed 7 --out runs/seven      (flags win over the file)")]
pub struct Generate {
    /// Settings as TOML, with the names of these flags; flags win.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Where to put the run; the same command again continues it.
    #[arg(long, value_name = "DIR", required_unless_present = "dry_run")]
    pub out: Option<PathBuf>,
    /// Only say what the run would ask of models, but for what is asked or written again: calls, tokens and money.
    #[arg(long)]
    pub dry_run: bool,
    /// The world.
    #[command(flatten)]
    pub world: World,
    /// Walk the paths of a dataset: R2R, REVERIE, RxR or Wayword.
    #[arg(long, value_name = "FILE")]
    pub episodes: Option<PathBuf>,
    /// Walk so many random paths. [default: 10, where no episodes are given]
    #[arg(long, value_name = "N")]
    pub paths: Option<usize>,
    /// Keep to this scene; may be given several times.
    #[arg(long, value_name = "SCENE")]
    pub scan: Option<Vec<String>>,
    /// Hops of random paths. [default: 4..7]
    #[arg(long, value_name = "FROM..TO")]
    pub hops: Option<String>,
    /// Lengths of random paths in metres. [default: 5..20]
    #[arg(long, value_name = "FROM..TO")]
    pub metres: Option<String>,
    /// Style: r2r, reverie, a TOML file, or NAME=DATASET for a dataset's own texts; may be given several times.
    #[arg(long, value_name = "STYLE")]
    pub style: Option<Vec<String>>,
    /// Caption the view along the heading, or four views around. [default: central]
    #[arg(long)]
    pub frames: Option<Frames>,
    /// Question by question, fixed queries without a dialogue, or a single request for a description. [default: dialogue]
    #[arg(long)]
    pub perception: Option<Perception>,
    /// Most questions per view. [default: 9]
    #[arg(long, value_name = "N")]
    pub questions: Option<usize>,
    /// Name the episode's object to the writer, or leave the choice to it. [default: given]
    #[arg(long)]
    pub target: Option<TargetMode>,
    /// How often a text that failed a check is written again. [default: 8, where a model writes 3]
    #[arg(long, value_name = "N")]
    pub repairs: Option<u32>,
    /// Hold texts against the platform's labels where it has them, or against the captions alone. [default: labels]
    #[arg(long)]
    pub evidence: Option<Against>,
    /// Seed of everything random; random paths are named by it, so runs that are to be merged need different ones. [default: 0]
    #[arg(long)]
    pub seed: Option<u64>,
    /// Only the first so many items.
    #[arg(long, value_name = "N")]
    pub limit: Option<usize>,
    /// Who asks, sees, sums up and writes.
    #[command(flatten)]
    pub roles: AskedRoles,
    /// How models are reached.
    #[command(flatten)]
    pub service: Service,
}

/// Which views are captioned, as typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Frames {
    /// The view along the heading.
    Central,
    /// North, east, south and west, condensed.
    Panoramic,
}

impl Generate {
    /// What the flags ask for.
    #[must_use]
    pub fn asked(&self) -> Asked {
        let frames = self.frames.map(|frames| match frames {
            Frames::Central => FrameSelection::Central,
            Frames::Panoramic => FrameSelection::Panoramic,
        });
        Asked {
            episodes: self.episodes.clone(),
            paths: self.paths,
            scan: self.scan.clone(),
            hops: self.hops.clone(),
            metres: self.metres.clone(),
            style: self.style.clone(),
            frames,
            perception: self.perception,
            questions: self.questions,
            target: self.target,
            repairs: self.repairs,
            seed: self.seed,
            limit: self.limit,
            evidence: self.evidence,
            roles: self.roles.clone(),
            service: self.service.clone(),
            ..self.world.asked()
        }
    }
}

/// `wayword check`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword check REVERIE_val_seen.json --platform matterport --data DATA --style reverie
  wayword check R2R_val_seen.json --platform matterport --data DATA --style r2r --json
  wayword check runs/houses/instructions.jsonl --platform house --style r2r")]
pub struct Check {
    /// Instructions: R2R, REVERIE, RxR or Wayword.
    pub file: PathBuf,
    /// The world.
    #[command(flatten)]
    pub world: World,
    /// The style that they are to keep to; without one only what they say of the path is checked.
    #[arg(long, value_name = "STYLE")]
    pub style: Option<String>,
    /// Show each instruction that did not pass, up to this number.
    #[arg(long, value_name = "N", default_value_t = 10)]
    pub show: usize,
}

/// `wayword export`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword export --run runs/val_seen --style reverie --format reverie --out val_seen_generated.json
  wayword export --run runs/a --run runs/b --format wayword --val-share 0.1 --out merged.jsonl")]
pub struct Export {
    /// Run folder; several only for format wayword, which merges them.
    #[arg(long, value_name = "DIR", required = true)]
    pub run: Vec<PathBuf>,
    /// Only instructions of this style.
    #[arg(long, value_name = "STYLE")]
    pub style: Option<String>,
    /// r2r, reverie, rxr, vlnce or wayword.
    #[arg(long)]
    pub format: String,
    /// The file to write; provenance goes beside it where the format's loaders choke on unknown fields.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Share of the scenes that go into the val split; no scene is in both.
    #[arg(long, value_name = "SHARE")]
    pub val_share: Option<f64>,
    /// Seed of that choice.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
}

/// `wayword report`.
#[derive(Debug, Args)]
#[command(
    after_long_help = "Examples:\n  wayword report --run runs/val_seen\n  wayword report --run runs/val_seen --items 20 --out page.html"
)]
pub struct Report {
    /// Run folder, or the folder of a comparison.
    #[arg(long, value_name = "DIR")]
    pub run: PathBuf,
    /// At most so many items; of a comparison, so many walks: of each agent and set some that succeed and some that do not.
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub items: usize,
    /// The page. [default: report.html in the run folder]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// `wayword house`.
#[derive(Debug, Args)]
#[command(after_long_help = "Examples:\n  wayword house --seed 7 --out houses")]
pub struct House {
    /// Which house.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Folder for house-SEED.glb, its navigation data, and what Habitat reads beside it.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

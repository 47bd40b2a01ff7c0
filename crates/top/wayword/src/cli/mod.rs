//! The command line as it is typed.

mod compare;
mod doctor;
mod evaluate;
mod ledger;
mod models;
mod perceive;
mod similarity;
mod view;

use crate::{
    settings::{Asked, World},
    styles,
};
use clap::{Args, Parser, Subcommand, builder::PossibleValuesParser};
use std::path::PathBuf;
use wayword_formats::Format;

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
  3  done, but some items failed, or some instructions failed a check; each with its reason
  4  another process works in the same run folder
  5  stopped before the end: a budget was spent or a key was refused; the same command goes on
  6  interrupted (Ctrl-C, SIGTERM); the same command goes on
  7  the world, a service or the disk was lost; the same command goes on";

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
    /// Write a run as HTML pages: map, frames, dialogue, captions, instructions and checks.
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
    /// The run.
    #[command(flatten)]
    pub asked: Asked,
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
    /// The style that all of them are to keep to. Without it, a text of Wayword's own keeps to the built-in style that it was
    /// written in, and of any other only what it says of the path is checked.
    #[arg(long, value_name = "STYLE", value_parser = styles::typed)]
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
    #[arg(long, value_parser = PossibleValuesParser::new(Format::ALL.map(Format::name)), hide_possible_values = true)]
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
    /// At most so many items, those with rejected and unverified texts first; of a comparison, so many walks: of each agent and set
    /// some that succeed and some that do not. [default: 1000; of a comparison 100]
    #[arg(long, value_name = "N")]
    pub items: Option<usize>,
    /// The page; of more than 50 items it is an overview, and the walks are on numbered pages beside it. [default: report.html in
    /// the run folder]
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Flags of `generate` that no settings file has.
    const FLAGS_ALONE: [&str; 3] = ["config", "dry_run", "out"];
    /// Tables of a settings file that no flag names.
    const TABLES: [&str; 3] = ["providers", "roles", "service"];

    /// The keys that a table of a settings file may have, as the error about another one lists them.
    fn keys(table: &str) -> Vec<String> {
        let error = toml::from_str::<Asked>(&format!("{table}\nno-such-key = 1")).unwrap_err().to_string();
        let (_, known) = error.split_once("expected one of ").unwrap();
        known.split('`').skip(1).step_by(2).map(str::to_owned).collect()
    }

    #[test]
    fn every_key_of_a_settings_file_has_its_flag_and_every_flag_its_key() {
        let generate = Generate::augment_args(clap::Command::new("generate"));
        let flags = generate.get_arguments().map(|flag| flag.get_long().unwrap().replace('-', "_"));
        let flags: BTreeSet<String> = flags.chain(TABLES.map(str::to_owned)).collect();
        let keys = ["", "[roles]", "[service]"].into_iter().flat_map(keys);
        let keys: BTreeSet<String> = keys.chain(FLAGS_ALONE.map(str::to_owned)).collect();
        assert_eq!(flags, keys);
        assert!(flags.len() > 40, "{flags:?}");
    }
}

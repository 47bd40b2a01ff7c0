//! The command line as the user types it.

mod check;
mod compare;
mod doctor;
mod evaluate;
mod export;
mod house;
mod launch;
mod ledger;
mod models;
mod perceive;
mod pictures;
mod robustness;
mod runs;
mod similarity;
mod steps;
mod study;
mod view;
mod workers;

use crate::settings::{Asked, AskedPlatform};
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

pub use check::{AskedWorld, Check, Detecting};
pub use compare::{AskedPrior, Compare, PICTURES, SuccessRule, SwapName};
pub use doctor::Doctor;
pub use evaluate::Evaluate;
pub use export::{AgentDataset, Export, ExportFormat};
pub use house::House;
pub use launch::{Launch, LaunchCommand, LaunchKubernetes, LaunchSlurm, Pair};
pub use ledger::{Ledger, LedgerCommand};
pub use models::{Models, ModelsCommand};
pub use perceive::Perceive;
pub use pictures::Pictured;
pub use robustness::Robustness;
pub use runs::{Runs, RunsCommand, RunsDatabase, RunsMerge, RunsQueue, RunsRetry, RunsStatus};
pub use similarity::{By, Similarity, Tokens};
pub use steps::AskedSteps;
pub use study::{
    Control, NamedSet, Study, StudyClose, StudyCommand, StudyForget, StudyInvite, StudyMode, StudyNew, StudyPlan,
    StudyReconcile, StudyRecruiter, StudyResults, StudyServe, StudyStatus,
};
pub use view::{View, ViewCommand, ViewMap, ViewPanorama, ViewPath, Walk};
pub use workers::AskedWorkers;

/// Writes and checks wayfinding instructions, as a person would give them to a robot, for any simulator.
#[derive(Debug, Parser)]
#[command(version, after_long_help = EXAMPLES)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Print the result as JSON on standard output.
    #[arg(long, global = true)]
    pub json: bool,
    /// Print no messages and no progress bar on standard error.
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

const EXAMPLES: &str = "\
Examples:
  wayword demo
      Write instructions in two styles for a path through a generated house. Then look at wayword-demo/report.html.
  wayword generate --platform house --paths 20 --style r2r --out runs/houses
      Write instructions for 20 random paths through generated houses.
  wayword generate --platform matterport --data DATA --episodes REVERIE_val_seen.json --style reverie --out runs/val_seen
      Write instructions for every path of a dataset. Give the same command again to continue a run that was stopped.
  wayword generate --paths 20 --style r2r --llm ollama/qwen3 --see ollama/llava --out runs/models
      The same with models: one asks, summarises and writes, the other looks at the pictures.
  wayword export --run runs/val_seen --style reverie --format reverie --out val_seen_generated.json
      Write the run as a file that agents of the benchmark read.
  wayword check REVERIE_val_seen.json --platform matterport --data DATA --style reverie
      Check anyone's instructions against what their paths show.
  wayword evaluate submission.json --episodes REVERIE_val_seen.json --platform matterport --data DATA
      Score anyone's trajectories as the official evaluators do, with confidence intervals.

Exit codes:
  0  done, and no check failed
  1  the input is wrong, or a file cannot be read or written
  2  the command line is wrong
  3  done, but some items failed, or some instructions failed a check; the reasons are listed
  4  another process is writing to the same run folder
  5  stopped early: the budget is spent or a key was refused; continue with a larger budget or a correct key
  6  interrupted (Ctrl-C, SIGTERM); the same command continues
  7  the simulator, a service or the disk failed; the same command continues";

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Write instructions for a path through a generated house, offline.
    Demo(Demo),
    /// Write instructions for paths, check them, and repair or reject those that fail.
    Generate(Box<Generate>),
    /// Check anyone's instructions against what their paths show.
    Check(Check),
    /// Learn from people's texts how far labels agree with single names of objects and rooms.
    Calibrate(Calibrate),
    /// Write a run as one file, in the format of R2R, REVERIE, RxR, VLN-CE or Wayword.
    Export(Box<Export>),
    /// Write a run as HTML pages: map, frames, dialogue, captions, instructions and checks.
    Report(Report),
    /// Measure captions against the labels of their views: objects named rightly, hallucinated objects, calls.
    Perceive(Box<Perceive>),
    /// Measure how similar two sets of instructions are, compared with two people and with random pairs.
    Similarity(Similarity),
    /// Let agents follow several sets of instructions, and compare how often each set leads them to the goal.
    Compare(Box<Compare>),
    /// Score anyone's trajectories as the evaluators of R2R and REVERIE do, with confidence intervals.
    Evaluate(Evaluate),
    /// Write a run's texts again in changed worlds, and say how much of them changes.
    Robustness(Box<Robustness>),
    /// Let people walk by texts, rate them or choose between them, on a site of your own.
    Study(Study),
    /// Check keys, servers, models and data, and say how to fix what is wrong.
    Doctor(Box<Doctor>),
    /// Show the kept calls to models, and what they cost.
    Ledger(Ledger),
    /// List, fetch or locate the models that run inside this program.
    Models(Models),
    /// List the platforms: what each needs and offers.
    Platforms,
    /// Draw a panorama, what is seen along a path, or a map.
    View(View),
    /// Print what starts many workers: a script for Slurm, a manifest for Kubernetes.
    Launch(Launch),
    /// Look after a run that many workers make: status, putting together, trying again.
    Runs(Runs),
    /// Save generated houses as a set of scenes that AI Habitat reads, with episodes that its agents walk.
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
    /// Seed of the house and of the path through it.
    #[arg(long, default_value_t = 3)]
    pub seed: u64,
    /// Folder for the run and its report.
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
  wayword generate --platform habitat --data SCENES --connectivity GRAPHS --paths 200 --out runs/scans
  wayword generate --style mine.toml --style r2r=R2R_train.json --out runs/styles
  wayword generate --paths 20 --llm ollama/qwen3 --see ollama/llava --out runs/models
  wayword generate --paths 20 --llm openai/gpt-4.1-mini --see openai/gpt-4.1-mini --max-usd 2 --dry-run
  wayword generate --config run.toml --seed 7 --out runs/seven      (flags win over the file)
  wayword generate --paths 100000 --out runs/big --plan             (then, on many machines, the same with:)
  wayword generate --paths 100000 --out runs/big --shard 3/64       (or: --queue wayword_db)
  wayword generate --paths 20 --out runs/houses --spans runs/houses-spans")]
pub struct Generate {
    /// Settings as TOML, with the names of these flags. A flag wins over the file.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Folder for the run; required without --dry-run. Give the same command again to continue it.
    #[arg(long, value_name = "DIR", required_unless_present = "dry_run")]
    pub out: Option<PathBuf>,
    /// Estimate the calls, tokens and money that the run would need, without making a call. The real run may need
    /// more, because questions that are asked twice and texts that are rewritten are not counted.
    #[arg(long)]
    pub dry_run: bool,
    /// Write what happens as spans into a file of this process in this folder: a line of JSON for the process and for each
    /// chunk, item and call of a model, when it ends, with its parent and how long it took. Without words of prompts and
    /// answers.
    #[arg(long, value_name = "FOLDER", conflicts_with = "dry_run")]
    pub spans: Option<PathBuf>,
    /// Which part of it this worker makes.
    #[command(flatten)]
    pub workers: AskedWorkers,
    /// The run.
    #[command(flatten)]
    pub asked: Asked,
}

/// `wayword calibrate`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword calibrate --platform matterport --data DATA --from R2R_train.json --out matterport.toml
  wayword check R2R_val_seen.json --platform matterport --data DATA --calibration matterport.toml")]
pub struct Calibrate {
    /// The platform.
    #[command(flatten)]
    pub platform: AskedPlatform,
    /// File of texts that people wrote: R2R, REVERIE, RxR or Wayword.
    #[arg(long, value_name = "FILE")]
    pub from: PathBuf,
    /// File to write.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
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
    /// Show at most this many items, those with rejected and unverified texts first. For a comparison: this many walks, with
    /// successes and failures of each agent and set. [default: 1000; for a comparison 100]
    #[arg(long, value_name = "N")]
    pub items: Option<usize>,
    /// HTML file to write. With more than 50 items it is an overview, and the items are on numbered pages beside it. [default:
    /// report.html in the run folder]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Flags of `generate` that have no key in a settings file.
    const FLAGS_ALONE: [&str; 10] =
        ["chunk", "config", "dry_run", "lease_s", "out", "password_env", "plan", "queue", "shard", "spans"];
    /// Tables of a settings file that have no flag.
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

    #[test]
    fn a_participant_whose_id_begins_with_a_hyphen_can_be_forgotten() {
        let typed = ["wayword", "study", "forget", "study", "--participant", "-HuqVrYIytaJwRfGxaH5Pw", "--dry-run"];
        let Command::Study(Study { command: StudyCommand::Forget(forget) }) =
            Cli::try_parse_from(typed).unwrap().command
        else {
            panic!("not read as forget");
        };
        assert_eq!((forget.participant.as_str(), forget.dry_run), ("-HuqVrYIytaJwRfGxaH5Pw", true));
    }
}

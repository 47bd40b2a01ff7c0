//! The command line: global flags and the list of commands, parsed by clap.

mod help;
mod parsing;

use crate::{
    demo::DemoArgs, doctor::args::DoctorArgs, house::args::HouseArgs, launch::args::LaunchArgs,
    ledger::args::LedgerArgs, models_args::ModelsArgs, report_command::ReportArgs, runs::args::RunsArgs,
};
use clap::{Parser, Subcommand};
#[cfg(not(feature = "experiments"))]
use std::ffi::OsString;
#[cfg(feature = "experiments")]
use wayword_experiments::{
    compare::args::CompareArgs, evaluate::args::EvaluateArgs, perceive::args::PerceiveArgs,
    robustness::args::RobustnessArgs, similarity::args::SimilarityArgs, study_args::StudyArgs,
};
use wayword_report::{export::args::ExportArgs, view::args::ViewArgs};
use wayword_run::{
    align::AlignArgs, annotate_args::AnnotateArgs, calibrate::CalibrateArgs, check::args::CheckArgs,
    generate::args::GenerateArgs,
};

pub use parsing::parse_arguments;

/// Writes and checks wayfinding instructions, as a person would give them to a robot, for any simulator.
#[derive(Debug, Parser)]
#[command(version, after_long_help = HELP_EXAMPLES, mut_subcommands = help::arrange_help)]
pub struct WaywordCli {
    /// What to do.
    #[command(subcommand)]
    pub command: WaywordCommand,
    /// Print the result as JSON on standard output.
    #[arg(long, global = true)]
    pub json: bool,
    /// Print no messages and no progress bar on standard error.
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

const HELP_EXAMPLES: &str = "\
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
pub enum WaywordCommand {
    /// Write instructions for a path through a generated house, offline.
    Demo(DemoArgs),
    /// Write instructions for paths, check them, and repair or reject those that fail.
    Generate(Box<GenerateArgs>),
    /// Check anyone's instructions against what their paths show.
    Check(Box<CheckArgs>),
    /// Write language into a copy of a LeRobot dataset: what is done now, what is left to do, other words, questions and answers.
    Annotate(Box<AnnotateArgs>),
    /// Find for each part of anyone's instructions the frames of its path that it describes.
    Align(AlignArgs),
    /// Learn from people's texts how far labels agree with single names of objects and rooms.
    Calibrate(CalibrateArgs),
    /// Write a run for other programs: in a dataset's format, as a table, or with pictures and actions as training code reads them.
    Export(Box<ExportArgs>),
    /// Write a run as HTML pages: map, frames, dialogue, captions, instructions and checks.
    Report(ReportArgs),
    /// Compare, evaluate and the other experiments, which this build lacks.
    #[cfg(not(feature = "experiments"))]
    #[command(
        name = "compare",
        visible_aliases = ["evaluate", "perceive", "robustness", "similarity", "study"],
        disable_help_flag = true
    )]
    Experiment {
        /// Everything after the name of the command.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
        rest: Vec<OsString>,
    },
    /// Measure captions against the labels of their views: objects named rightly, hallucinated objects, calls.
    #[cfg(feature = "experiments")]
    Perceive(Box<PerceiveArgs>),
    /// Measure how similar two sets of instructions are, compared with two people and with random pairs.
    #[cfg(feature = "experiments")]
    Similarity(SimilarityArgs),
    /// Let agents follow several sets of instructions, and compare how often each set leads them to the goal.
    #[cfg(feature = "experiments")]
    Compare(Box<CompareArgs>),
    /// Score anyone's trajectories as the evaluators of R2R and REVERIE do, with confidence intervals.
    #[cfg(feature = "experiments")]
    Evaluate(EvaluateArgs),
    /// Write a run's texts again in changed worlds, and say how much of them changes.
    #[cfg(feature = "experiments")]
    Robustness(Box<RobustnessArgs>),
    /// Let people walk by texts, rate them or choose between them, on a site of your own.
    #[cfg(feature = "experiments")]
    Study(StudyArgs),
    /// Check keys, servers, models and data, and say how to fix what is wrong.
    Doctor(Box<DoctorArgs>),
    /// Show the kept calls to models, and what they cost.
    Ledger(LedgerArgs),
    /// List, fetch or locate the models that run inside this program.
    Models(ModelsArgs),
    /// List the platforms: what each needs and offers.
    #[command(after_long_help = "Examples:\n  wayword platforms\n  wayword platforms --json")]
    Platforms,
    /// Draw a panorama, what is seen along a path, or a map.
    View(ViewArgs),
    /// Print what starts many workers: a script for Slurm, a manifest for Kubernetes.
    Launch(LaunchArgs),
    /// Look after a run that many workers make: status, putting together, trying again.
    Runs(RunsArgs),
    /// Save generated houses as a set of scenes that AI Habitat reads, with episodes that its agents walk.
    House(HouseArgs),
    /// Print shell completions.
    #[command(after_long_help = "\
Examples:
  wayword completions bash > ~/.local/share/bash-completion/completions/wayword
  wayword completions zsh > ~/.zfunc/_wayword
  wayword completions fish > ~/.config/fish/completions/wayword.fish")]
    Completions {
        /// For which shell.
        shell: clap_complete::Shell,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Args;
    use std::collections::BTreeSet;
    #[cfg(feature = "experiments")]
    use wayword_experiments::study_args::StudyCommand;
    use wayword_run::settings::AskedSettings;

    /// Flags of `generate` that have no key in a settings file.
    const FLAGS_ALONE: [&str; 10] =
        ["chunk", "config", "dry_run", "lease_s", "out", "password_env", "plan", "queue", "shard", "spans"];
    /// Tables of a settings file that have no flag.
    const TABLES: [&str; 3] = ["providers", "roles", "service"];

    /// The keys that a table of a settings file may have, as the error about another one lists them.
    fn keys(table: &str) -> Vec<String> {
        let error = toml::from_str::<AskedSettings>(&format!("{table}\nno-such-key = 1")).unwrap_err().to_string();
        let (_, known) = error.split_once("expected one of ").unwrap();
        known.split('`').skip(1).step_by(2).map(str::to_owned).collect()
    }

    #[test]
    fn settings_file_keys_and_flags_correspond() {
        let generate = GenerateArgs::augment_args(clap::Command::new("generate"));
        let flags = generate.get_arguments().map(|flag| flag.get_long().unwrap().replace('-', "_"));
        let flags: BTreeSet<String> = flags.chain(TABLES.map(str::to_owned)).collect();
        let keys = ["", "[roles]", "[service]"].into_iter().flat_map(keys);
        let keys: BTreeSet<String> = keys.chain(FLAGS_ALONE.map(str::to_owned)).collect();
        assert_eq!(flags, keys);
        assert!(flags.len() > 40, "{flags:?}");
    }

    #[cfg(feature = "experiments")]
    #[test]
    fn a_participant_whose_id_begins_with_a_hyphen_can_be_forgotten() {
        let typed = ["wayword", "study", "forget", "study", "--participant", "-HuqVrYIytaJwRfGxaH5Pw", "--dry-run"];
        let WaywordCommand::Study(StudyArgs { command: StudyCommand::Forget(forget) }) =
            WaywordCli::try_parse_from(typed).unwrap().command
        else {
            panic!("not read as forget");
        };
        assert_eq!((forget.participant.as_str(), forget.dry_run), ("-HuqVrYIytaJwRfGxaH5Pw", true));
    }
}

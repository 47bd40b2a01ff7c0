//! Dispatches each command to the function that runs it.

#[cfg(feature = "local")]
use crate::models;
use crate::{
    cli::WaywordCommand, completions, demo, doctor, house, launch, ledger, platform_list, report_command, runs,
};
#[cfg(feature = "experiments")]
use wayword_experiments::{compare, evaluate, perceive, robustness, similarity};
#[cfg(feature = "study")]
use wayword_experiments::{study, study_args::StudyCommand};
use wayword_report::{export, pair_check, view};
use wayword_run::{
    align, calibrate, check,
    error::{CommandError, Exit},
    generate,
    output::CommandOutput,
    pairs::args::CheckBy,
};

/// Runs a command.
///
/// # Errors
/// The error of the command. The caller prints it.
pub fn run_command(command: WaywordCommand, output: &CommandOutput) -> Result<Exit, CommandError> {
    let _watch = long_command_name(&command).map(|name| output.watch_silence(name));
    match command {
        WaywordCommand::Demo(args) => demo::run_demo(&args, output),
        WaywordCommand::Generate(args) => generate::run_generate(&args, output),
        WaywordCommand::Check(args) if args.pairs.by == CheckBy::Pictures => pair_check::run_pair_check(&args, output),
        WaywordCommand::Check(args) => check::run_check(&args, output),
        #[cfg(all(feature = "lerobot", feature = "parquet"))]
        WaywordCommand::Annotate(args) => wayword_report::annotate::run_annotate(&args, output),
        #[cfg(not(all(feature = "lerobot", feature = "parquet")))]
        WaywordCommand::Annotate(_) => Err(CommandError::not_built(
            "datasets cannot be annotated: this build reads no LeRobot datasets or writes no tables",
        )),
        WaywordCommand::Align(args) => align::run_align(&args, output),
        WaywordCommand::Calibrate(args) => calibrate::run_calibrate(&args, output),
        WaywordCommand::Export(args) => export::run_export(&args, output),
        WaywordCommand::Report(args) => report_command::run_report(&args, output),
        #[cfg(feature = "experiments")]
        WaywordCommand::Compare(args) => compare::run_comparison(&args, output),
        #[cfg(feature = "experiments")]
        WaywordCommand::Evaluate(args) => evaluate::run_evaluate(&args, output),
        #[cfg(feature = "experiments")]
        WaywordCommand::Perceive(args) => perceive::run_perceive(&args, output),
        #[cfg(feature = "experiments")]
        WaywordCommand::Robustness(args) => robustness::run_robustness(&args, output),
        #[cfg(feature = "experiments")]
        WaywordCommand::Similarity(args) => similarity::run_similarity(&args, output),
        #[cfg(feature = "study")]
        WaywordCommand::Study(args) => study::run_study(&args, output),
        #[cfg(not(feature = "experiments"))]
        WaywordCommand::Experiment { .. } => Err(CommandError::not_built(
            "this build has no experiments: compare, evaluate, perceive, robustness, similarity, study",
        )),
        #[cfg(all(feature = "experiments", not(feature = "study")))]
        WaywordCommand::Study(_) => {
            Err(CommandError::not_built("there are no studies: this build has no site for them"))
        }
        WaywordCommand::Doctor(args) => doctor::run_doctor(&args, output),
        WaywordCommand::Ledger(args) => ledger::run_ledger(&args, output),
        #[cfg(feature = "local")]
        WaywordCommand::Models(args) => models::run_models(&args, output),
        #[cfg(not(feature = "local"))]
        WaywordCommand::Models(_) => {
            Err(CommandError::not_built("models cannot be fetched or listed: this build runs none in process"))
        }
        WaywordCommand::Platforms => platform_list::list_platforms(output),
        WaywordCommand::View(args) => view::run_view(&args, output),
        WaywordCommand::Launch(args) => launch::run_launch(&args, output),
        WaywordCommand::Runs(args) => runs::run_runs(&args, output),
        WaywordCommand::House(args) => house::run_house(&args, output),
        WaywordCommand::Completions { shell } => completions::print_completions(shell),
    }
}

/// The name of a command that may take long, for lines about its progress. Commands that are over at once, or that serve until they
/// are ended, have none.
fn long_command_name(command: &WaywordCommand) -> Option<&'static str> {
    Some(match command {
        WaywordCommand::Demo(_) => "demo",
        WaywordCommand::Generate(_) => "generate",
        WaywordCommand::Check(_) => "check",
        WaywordCommand::Annotate(_) => "annotate",
        WaywordCommand::Align(_) => "align",
        WaywordCommand::Calibrate(_) => "calibrate",
        WaywordCommand::Export(_) => "export",
        WaywordCommand::Report(_) => "report",
        #[cfg(feature = "experiments")]
        WaywordCommand::Compare(_) => "compare",
        #[cfg(feature = "experiments")]
        WaywordCommand::Evaluate(_) => "evaluate",
        #[cfg(feature = "experiments")]
        WaywordCommand::Perceive(_) => "perceive",
        #[cfg(feature = "experiments")]
        WaywordCommand::Robustness(_) => "robustness",
        #[cfg(feature = "experiments")]
        WaywordCommand::Similarity(_) => "similarity",
        #[cfg(feature = "study")]
        WaywordCommand::Study(args) if !matches!(args.command, StudyCommand::Serve(_)) => "study",
        WaywordCommand::Doctor(_) => "doctor",
        WaywordCommand::Ledger(_) => "ledger",
        WaywordCommand::Models(_) => "models",
        WaywordCommand::View(_) => "view",
        WaywordCommand::House(_) => "house",
        WaywordCommand::Runs(args) if !runs::is_watching(args) => "runs",
        _ => return None,
    })
}

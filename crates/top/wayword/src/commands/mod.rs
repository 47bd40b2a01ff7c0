//! Dispatches each command to the function that runs it.

#[cfg(feature = "local")]
use crate::models;
use crate::{cli::Command, completions, demo, doctor, house, launch, ledger, platform_list, report_command, runs};
#[cfg(feature = "study")]
use wayword_experiments::study;
use wayword_experiments::{compare, evaluate, perceive, robustness, similarity};
use wayword_report::{export, view};
use wayword_run::{
    calibrate, check,
    error::{Error, Exit},
    generate,
    output::Output,
};

/// Runs a command.
///
/// # Errors
/// The error of the command. The caller prints it.
pub fn run(command: Command, output: &Output) -> Result<Exit, Error> {
    match command {
        Command::Demo(args) => demo::run(&args, output),
        Command::Generate(args) => generate::run(&args, output),
        Command::Check(args) => check::run(&args, output),
        Command::Calibrate(args) => calibrate::run(&args, output),
        Command::Export(args) => export::run(&args, output),
        Command::Report(args) => report_command::run(&args, output),
        Command::Compare(args) => compare::compared(&args, output),
        Command::Evaluate(args) => evaluate::run(&args, output),
        Command::Perceive(args) => perceive::run(&args, output),
        Command::Robustness(args) => robustness::run(&args, output),
        Command::Similarity(args) => similarity::run(&args, output),
        #[cfg(feature = "study")]
        Command::Study(args) => study::run(&args, output),
        #[cfg(not(feature = "study"))]
        Command::Study(_) => Err(Error::not_built("there are no studies: this build has no site for them")),
        Command::Doctor(args) => doctor::run(&args, output),
        Command::Ledger(args) => ledger::run(&args, output),
        #[cfg(feature = "local")]
        Command::Models(args) => models::run(&args, output),
        #[cfg(not(feature = "local"))]
        Command::Models(_) => {
            Err(Error::not_built("models cannot be fetched or listed: this build runs none in process"))
        }
        Command::Platforms => platform_list::run(output),
        Command::View(args) => view::run(&args, output),
        Command::Launch(args) => launch::run(&args, output),
        Command::Runs(args) => runs::run(&args, output),
        Command::House(args) => house::run(&args, output),
        Command::Completions { shell } => completions::run(shell),
    }
}

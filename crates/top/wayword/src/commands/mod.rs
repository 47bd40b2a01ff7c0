//! One file per command.

pub(crate) mod calibrate;
mod check;
pub(crate) mod compare;
mod completions;
mod config;
mod demo;
mod doctor;
mod evaluate;
mod export;
mod generate;
mod house;
mod launch;
mod ledger;
#[cfg(feature = "local")]
mod models;
mod perceive;
mod platforms;
mod report;
pub(crate) mod robustness;
mod runs;
mod similarity;
#[cfg(feature = "study")]
mod study;
mod view;

use crate::{
    cli::Command,
    error::{Error, Exit},
    output::Output,
};

pub use check::{AmbiguousText, CheckReport, CheckedText, Counts, DoubtedText, How, check_file, checked};
pub use compare::compared;
#[cfg(feature = "habitat")]
pub use export::{Replayed, replayed};
pub use generate::{Searched, Summary, generate_into};
pub use perceive::{Extent, Measured, OfDetector, Row, measure_detector, perceive};

/// Runs a command.
///
/// # Errors
/// What went wrong. The caller prints it once.
pub fn run(command: Command, output: &Output) -> Result<Exit, Error> {
    match command {
        Command::Demo(args) => demo::run(&args, output),
        Command::Generate(args) => generate::run(&args, output),
        Command::Check(args) => check::run(&args, output),
        Command::Calibrate(args) => calibrate::run(&args, output),
        Command::Export(args) => export::run(&args, output),
        Command::Report(args) => report::run(&args, output),
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
        Command::Platforms => platforms::run(output),
        Command::View(args) => view::run(&args, output),
        Command::Launch(args) => launch::run(&args, output),
        Command::Runs(args) => runs::run(&args, output),
        Command::House(args) => house::run(&args, output),
        Command::Completions { shell } => completions::run(shell),
    }
}

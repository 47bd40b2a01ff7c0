//! One file per command.

mod check;
pub(crate) mod compare;
mod completions;
mod config;
mod demo;
#[cfg(feature = "remote")]
mod doctor;
mod evaluate;
mod export;
mod generate;
mod house;
#[cfg(feature = "remote")]
mod ledger;
mod models;
mod perceive;
mod platforms;
mod report;
mod similarity;
mod view;

use crate::{
    cli::Command,
    error::{Error, Exit},
    output::Output,
};

pub use check::{CheckReport, CheckedText, Counts, check_file};
pub use generate::{Summary, generate_into};
pub use perceive::{Extent, Measured, Row, perceive};

/// Runs a command.
///
/// # Errors
/// What went wrong, to be told once.
pub fn run(command: Command, output: &Output) -> Result<Exit, Error> {
    match command {
        Command::Demo(args) => demo::run(&args, output),
        Command::Generate(args) => generate::run(&args, output),
        Command::Check(args) => check::run(&args, output),
        Command::Export(args) => export::run(&args, output),
        Command::Report(args) => report::run(&args, output),
        Command::Compare(args) => compare::run(&args, output),
        Command::Evaluate(args) => evaluate::run(&args, output),
        Command::Perceive(args) => perceive::run(&args, output),
        Command::Similarity(args) => similarity::run(&args, output),
        #[cfg(feature = "remote")]
        Command::Doctor(args) => doctor::run(&args, output),
        #[cfg(feature = "remote")]
        Command::Ledger(args) => ledger::run(&args, output),
        Command::Models(args) => models::run(&args, output),
        Command::Platforms => platforms::run(output),
        Command::View(args) => view::run(&args, output),
        Command::House(args) => house::run(&args, output),
        Command::Completions { shell } => completions::run(shell),
    }
}

//! The command line of Wayword: configuration, wiring, progress, run folders and reports.
//!
//! This is a library beside the binary, so that `wayword-measure` and the Python package run exactly what users run.

mod at_once;
pub mod by_pictures;
mod calibration;
pub mod calls;
pub mod cli;
#[cfg(feature = "local")]
mod clip;
pub mod commands;
mod count;
pub mod demands;
pub mod doubts;
#[cfg(feature = "local")]
mod download_bar;
pub mod encoder;
pub mod episodes;
pub mod error;
pub mod explained;
pub mod follow;
mod in_order;
pub mod interrupt;
pub mod item;
pub mod judge;
pub mod looking_for;
mod losses;
pub mod meant;
pub mod output;
mod own_format;
pub mod people;
pub mod pictures;
pub mod pipeline;
pub mod plan;
pub mod platforms;
pub mod report;
pub mod run;
pub mod settings;
mod similar;
mod stores;
pub mod styles;
pub mod team;
mod terms;
mod text_file;
mod texts;
mod usable;
#[cfg(feature = "habitat")]
mod walking;
mod watch;

use clap::Parser;
use cli::Cli;
use error::Exit;
use output::Output;
use std::ffi::OsString;

/// The program, with its name and its arguments. Returns the exit code.
#[must_use]
pub fn main(arguments: Vec<OsString>) -> u8 {
    wayword_platforms::process::stand_guard_if_asked(arguments.get(1..).unwrap_or_default());
    let pending = interrupt::catch();
    leave_contained_panics_to_errors();
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(told) => {
            // A closed output is no error.
            let _ = told.print();
            return u8::try_from(told.exit_code()).unwrap_or(u8::MAX);
        }
    };
    let output = Output::new(cli.json, cli.quiet);
    interrupt::listen(pending, &output);
    match commands::run(cli.command, &output) {
        Ok(exit) => exit as u8,
        Err(error) => {
            output.error(&error);
            match error.exit_code() {
                // After an interrupt, a call that was not sent or a simulator that was ended looks like a failure.
                Exit::Stopped | Exit::Lost if interrupt::is_asked() => Exit::Interrupted as u8,
                exit => exit as u8,
            }
        }
    }
}

/// If a decoder panics on a file, the error about that file reports it, and the panic prints nothing.
pub fn leave_contained_panics_to_errors() {
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !wayword_core::contain::is_contained() {
            report(panic);
        }
    }));
}

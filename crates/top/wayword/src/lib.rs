//! The command line of Wayword. Most commands are implemented in `wayword-run`, `wayword-report` and `wayword-experiments`; this
//! crate parses the command line and dispatches to them. It also has the small commands around runs: demo, doctor, house,
//! ledger, models, launch, runs.
//!
//! It is a library with a thin binary, so that the Python package runs the same code as the command line.
//!
//! # Where things are
//! - [`cli`]: all commands. The flags of each are in `args.rs` beside its work, in the crate that does it.
//! - [`commands`]: which function runs a command.
//! - `doctor/scenes.rs`: what `doctor --scenes` lists of a scene.
//! - `doctor/turning.rs`: whether things move to the left when one turns right, in a world of another program.
//! - `house/`: the set of houses for Habitat, its episodes and habitat-lab's configuration.
//! - `runs/`: `merge.rs` puts chunks together, `status.rs` and `prometheus.rs` show them.
//! - `tests/it/documents.rs`: which commands of the documents are run, and what the others need.
//! - `tests/it/invariants/`: the tests of the source itself.

pub mod cli;
pub mod commands;
mod completions;
mod demo;
mod doctor;
mod house;
mod launch;
mod ledger;
#[cfg(feature = "local")]
mod models;
mod models_args;
mod platform_list;
mod report_command;
mod runs;

use std::{borrow::Cow, ffi::OsString};
use wayword_run::{
    error::Exit,
    interrupt,
    output::{CommandOutput, mask_credentials, print_foreign_line},
};
/// Runs the program; `arguments` begins with its name. Returns the exit code.
#[must_use]
pub fn main(arguments: Vec<OsString>) -> u8 {
    wayword_platforms::process::stand_guard_if_asked(arguments.get(1..).unwrap_or_default());
    let pending = interrupt::catch_signals();
    leave_contained_panics_to_errors();
    let cli = match cli::parse_arguments(arguments) {
        Ok(cli) => cli,
        Err(parse_error) => {
            // A closed output is no error. A value that is quoted may be an address with a password in it.
            match mask_credentials(&parse_error.render().to_string()) {
                Cow::Owned(masked) if parse_error.use_stderr() => print_foreign_line(masked.trim_end()),
                _ => drop(parse_error.print()),
            }
            return u8::try_from(parse_error.exit_code()).unwrap_or(u8::MAX);
        }
    };
    let output = CommandOutput::new(cli.json, cli.quiet);
    interrupt::listen_for_signals(pending, &output);
    match commands::run_command(cli.command, &output).and_then(|exit| output.expect_printed().map(|()| exit)) {
        Ok(exit) => exit as u8,
        Err(error) => {
            output.print_error(&error);
            match error.exit_code() {
                // After an interrupt, a call that was not sent or a simulator that was ended looks like a failure.
                Exit::Stopped | Exit::Lost if interrupt::is_interrupted() => Exit::Interrupted as u8,
                exit => exit as u8,
            }
        }
    }
}

/// If a decoder panics on a file, the error about that file reports it, and the message of the panic is not printed.
pub fn leave_contained_panics_to_errors() {
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !wayword_core::contain_panics::is_contained() {
            report(panic);
        }
    }));
}

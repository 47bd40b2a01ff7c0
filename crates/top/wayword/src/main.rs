//! `wayword`: see `wayword --help`.

use clap::Parser;
use std::process::ExitCode;
use wayword::{cli::Cli, commands, error::Exit, interrupt, output::Output};

fn main() -> ExitCode {
    wayword_platforms::process::stand_guard_if_asked();
    let pending = interrupt::catch();
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        // If a decoder panics on a file, the error about that file reports it.
        if !wayword_core::contain::is_contained() {
            report(panic);
        }
    }));
    let cli = Cli::parse();
    let output = Output::new(cli.json, cli.quiet);
    interrupt::listen(pending, &output);
    match commands::run(cli.command, &output) {
        Ok(code) => code.into(),
        Err(error) => {
            output.error(&error);
            match error.exit_code() {
                // After an interrupt, a call that was not sent or a simulator that was ended looks like a failure.
                Exit::Stopped | Exit::Lost if interrupt::is_asked() => Exit::Interrupted.into(),
                code => code.into(),
            }
        }
    }
}

//! `wayword`: see `wayword --help`.

use clap::Parser;
use std::process::ExitCode;
use wayword::{cli::Cli, commands, output::Output};

fn main() -> ExitCode {
    let cli = Cli::parse();
    let output = Output::new(cli.json, cli.quiet);
    match commands::run(cli.command, &output) {
        Ok(code) => code.into(),
        Err(error) => {
            output.error(&error);
            error.exit_code().into()
        }
    }
}

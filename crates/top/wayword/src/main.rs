//! `wayword`: see `wayword --help`.

use clap::Parser;
use std::process::ExitCode;
use wayword::{cli::Cli, commands, error::Exit, interrupt, output::Output};

fn main() -> ExitCode {
    wayword_platforms::process::stand_guard_if_asked();
    let tell = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        // A decoder that broke on a file is told of by the error about the file.
        if !wayword_core::contain::is_contained() {
            tell(panic);
        }
    }));
    let cli = Cli::parse();
    let output = Output::new(cli.json, cli.quiet);
    interrupt::listen(&output);
    match commands::run(cli.command, &output) {
        Ok(code) => code.into(),
        Err(error) => {
            output.error(&error);
            match error.exit_code() {
                // What an interrupt cut off looks like a call that was not let out, or a world that was lost.
                Exit::Stopped | Exit::Lost if interrupt::is_asked() => Exit::Interrupted.into(),
                code => code.into(),
            }
        }
    }
}

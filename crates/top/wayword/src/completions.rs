//! `wayword completions`: prints the completion script for a shell.

use crate::cli::WaywordCli;
use clap::CommandFactory;
use std::io::{self, Write};
use wayword_run::error::{CommandError, Exit};

pub(crate) fn print_completions(shell: clap_complete::Shell) -> Result<Exit, CommandError> {
    // `clap_complete` panics when it cannot write. A closed pipe is not an error.
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut WaywordCli::command(), "wayword", &mut script);
    let mut out = io::stdout();
    match out.write_all(&script).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(CommandError::io("standard output", "write")(error))
        }
        _ => Ok(Exit::Done),
    }
}

//! `wayword completions`.

use crate::{
    cli::Cli,
    error::{Error, Exit},
};
use clap::CommandFactory;
use std::io::{self, Write};

pub(super) fn run(shell: clap_complete::Shell) -> Result<Exit, Error> {
    // `clap_complete` panics when it cannot write. A reader that has gone away is no error.
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "wayword", &mut script);
    let _ = io::stdout().write_all(&script);
    Ok(Exit::Done)
}

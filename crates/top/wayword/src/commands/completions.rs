//! `wayword completions`.

use crate::{
    cli::Cli,
    error::{Error, Exit},
};
use clap::CommandFactory;

pub(super) fn run(shell: clap_complete::Shell) -> Result<Exit, Error> {
    clap_complete::generate(shell, &mut Cli::command(), "wayword", &mut std::io::stdout());
    Ok(Exit::Done)
}

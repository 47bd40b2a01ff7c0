//! `wayword report`.
use crate::{cli::Report, error::{Error, Exit}, output::Output};

pub(super) fn run(_args: &Report, _output: &Output) -> Result<Exit, Error> {
    Err(Error::usage("not yet", "not yet"))
}

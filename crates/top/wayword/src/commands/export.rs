//! `wayword export`.
use crate::{cli::Export, error::{Error, Exit}, output::Output};

pub(super) fn run(_args: &Export, _output: &Output) -> Result<Exit, Error> {
    Err(Error::usage("not yet", "not yet"))
}

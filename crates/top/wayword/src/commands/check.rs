//! `wayword check`.
use crate::{cli::Check, error::{Error, Exit}, output::Output};

pub(super) fn run(_args: &Check, _output: &Output) -> Result<Exit, Error> {
    Err(Error::usage("not yet", "not yet"))
}

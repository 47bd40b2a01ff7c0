//! `wayword house`.
use crate::{cli::House, error::{Error, Exit}, output::Output};

pub(super) fn run(_args: &House, _output: &Output) -> Result<Exit, Error> {
    Err(Error::usage("not yet", "not yet"))
}

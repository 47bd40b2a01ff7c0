//! `wayword demo`.
use crate::{cli::Demo, error::{Error, Exit}, output::Output};

pub(super) fn run(_args: &Demo, _output: &Output) -> Result<Exit, Error> {
    Err(Error::usage("not yet", "not yet"))
}

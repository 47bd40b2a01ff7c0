//! Trajectories, in a build that knows no navmeshes.

use crate::{
    cli::Export,
    error::{Error, Exit},
    output::Output,
};
use std::path::Path;
use wayword_formats::jsonl::Record;

pub(super) fn write(_args: &Export, _out: &Path, _records: &[Record], _output: &Output) -> Result<Exit, Error> {
    Err(Error::not_built("there are no navmeshes: this build has no platform habitat"))
}

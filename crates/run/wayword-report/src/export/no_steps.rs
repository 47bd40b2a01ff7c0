//! Stands in for `steps` in a build without the feature `habitat`: without navmeshes there are no trajectories.

use crate::export::args::Export;
use std::path::Path;
use wayword_formats::jsonl::Record;
use wayword_run::{
    error::{Error, Exit},
    output::Output,
};

pub(super) fn write(_args: &Export, _out: &Path, _records: &[Record], _output: &Output) -> Result<Exit, Error> {
    Err(Error::not_built("there are no navmeshes: this build has no platform habitat"))
}

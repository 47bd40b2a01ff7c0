//! Replaces `table` in a build without the feature `parquet`: both of its functions report that the build writes no tables.

use crate::export::args::Export;
use std::path::Path;
use wayword_formats::jsonl::Record;
use wayword_run::{error::Error, output::Output};

pub(super) fn write(_args: &Export, _out: &Path, _records: &[Record], _output: &Output) -> Result<(), Error> {
    Err(Error::not_built("--format parquet: this build writes no tables"))
}

pub(super) fn publish(_args: &Export, _out: &Path, _records: &[Record], _output: &Output) -> Result<(), Error> {
    Err(Error::not_built("--format hf: this build writes no tables"))
}

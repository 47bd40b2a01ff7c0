//! A build without Parquet.

use crate::{cli::Export, error::Error, output::Output};
use std::path::Path;
use wayword_formats::jsonl::Record;

pub(super) fn write(_args: &Export, _out: &Path, _records: &[Record], _output: &Output) -> Result<(), Error> {
    Err(Error::not_built("--format parquet: this build writes no tables"))
}

pub(super) fn publish(_args: &Export, _out: &Path, _records: &[Record], _output: &Output) -> Result<(), Error> {
    Err(Error::not_built("--format hf: this build writes no tables"))
}

//! Replaces `table` in a build without the feature `parquet`: both of its functions report that the build writes no tables.

use crate::export::args::ExportArgs;
use std::path::Path;
use wayword_formats::jsonl::InstructionRecord;
use wayword_run::{error::CommandError, output::CommandOutput};

pub(super) fn write_table(
    _args: &ExportArgs,
    _out: &Path,
    _records: &[InstructionRecord],
    _output: &CommandOutput,
) -> Result<(), CommandError> {
    Err(CommandError::not_built("--format parquet: this build writes no tables"))
}

pub(super) fn publish_tables(
    _args: &ExportArgs,
    _out: &Path,
    _records: &[InstructionRecord],
    _output: &CommandOutput,
) -> Result<(), CommandError> {
    Err(CommandError::not_built("--format hf: this build writes no tables"))
}

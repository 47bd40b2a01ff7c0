//! Stands in for `steps` in a build without the feature `habitat`: without navmeshes there are no trajectories.

use crate::export::args::ExportArgs;
use std::path::Path;
use wayword_formats::jsonl::InstructionRecord;
use wayword_run::{
    error::{CommandError, Exit},
    output::CommandOutput,
};

pub(super) fn write_steps(
    _args: &ExportArgs,
    _out: &Path,
    _records: &[InstructionRecord],
    _output: &CommandOutput,
) -> Result<Exit, CommandError> {
    Err(CommandError::not_built("there are no navmeshes: this build has no platform habitat"))
}

//! Stands in for `layouts` in a build without the feature `habitat`: without navmeshes there are no steps to pack.

use crate::export::args::{ExportArgs, ExportFormat};
use std::path::Path;
use wayword_run::{
    error::{CommandError, Exit},
    output::CommandOutput,
};

pub(super) fn export_layout(
    _args: &ExportArgs,
    (format, _out): (ExportFormat, &Path),
    _output: &CommandOutput,
) -> Result<Exit, CommandError> {
    Err(CommandError::not_built(format!("--format {format}: this build has no platform habitat, and so no navmeshes")))
}

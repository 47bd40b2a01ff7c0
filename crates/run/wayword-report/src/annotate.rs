//! `wayword annotate`: writes language into a copy of a dataset, and the page about it.

use crate::pages::curate::write_annotation_pages;
use wayword_run::{
    annotate::annotate_dataset,
    annotate_args::AnnotateArgs,
    error::{CommandError, Exit},
    output::CommandOutput,
};

/// Runs `wayword annotate`, and prints the result.
///
/// # Errors
/// As [`annotate_dataset`], and when a page cannot be written.
pub fn run_annotate(args: &AnnotateArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    let report = annotate_dataset(args, output)?;
    let page = write_annotation_pages(&report)?;
    output.say(format_args!("page: {}", page.display()));
    output.print_result(&report, &report);
    Ok(Exit::Done)
}

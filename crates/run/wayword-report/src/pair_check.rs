//! `wayword check --by pictures`: judges pairs, and writes the page for curators.

use crate::pages::curate::write_curators_pages;
use wayword_run::{
    check::args::CheckArgs,
    error::{CommandError, Exit},
    output::CommandOutput,
    pairs::judge_pairs,
};

/// Runs `wayword check --by pictures`, and prints the result.
///
/// # Errors
/// As [`judge_pairs`], and when a page cannot be written.
pub fn run_pair_check(args: &CheckArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    let report = judge_pairs(args, output)?;
    if let Some(folder) = &args.pairs.out {
        let page = write_curators_pages(folder, &report)?;
        output.say(format_args!("page for curators: {}", page.display()));
    }
    let is_complete = report.unjudged == 0;
    output.print_result(&report, &report);
    Ok(if is_complete { Exit::Done } else { Exit::WithLoss })
}

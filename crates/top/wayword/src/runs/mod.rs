//! `wayword runs`: shows, merges and retries a run that many workers make.

pub(crate) mod args;
mod damage;
mod database;
mod merge;
mod prometheus;
mod retry;
mod status;

use crate::runs::args::{RunsArgs, RunsCommand};
use wayword_run::{
    error::{CommandError, Exit},
    output::CommandOutput,
};

/// Whether the command shows a run again and again until it is ended.
pub(crate) fn is_watching(args: &RunsArgs) -> bool {
    matches!(&args.command, RunsCommand::Status(status) if status.watch)
}

pub(crate) fn run_runs(args: &RunsArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    match &args.command {
        RunsCommand::Status(args) => status::run_status(args, |status| match args.prometheus {
            true => output.print_result(status, prometheus::prometheus_text(status)),
            false => output.print_result(status, status),
        }),
        RunsCommand::Merge(args) => merge::run_merge(args, output),
        RunsCommand::Retry(args) => retry::run_retry(args, output),
        RunsCommand::Database(args) => database::run_database(args, output),
    }
}

//! `wayword runs`: shows, merges and retries a run that many workers make.

pub(crate) mod args;
mod damage;
mod database;
mod merge;
mod prometheus;
mod retry;
mod status;
mod unfinished;

use crate::runs::args::{RunsArgs, RunsCommand, RunsMerge, RunsQueue, RunsRetry, RunsStatus};
use std::path::Path;
use wayword_queue::ChunkPlan;
use wayword_run::{
    error::{CommandError, Exit},
    generate::ChunkHandout,
    output::CommandOutput,
    run_folder::is_begun,
    stores::store_address,
};

/// Whether the command shows a run again and again until it is ended.
pub(crate) fn is_watching(args: &RunsArgs) -> bool {
    matches!(&args.command, RunsCommand::Status(status) if status.watch)
}

pub(crate) fn run_runs(args: &RunsArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    match &args.command {
        RunsCommand::Status(RunsStatus { run, .. })
        | RunsCommand::Merge(RunsMerge { run, .. })
        | RunsCommand::Retry(RunsRetry { run, .. }) => refuse_single_run(run)?,
        RunsCommand::Database(_) => {}
    }
    if let RunsCommand::Status(RunsStatus { run, database, .. }) | RunsCommand::Retry(RunsRetry { run, database, .. }) =
        &args.command
    {
        refuse_needless_queue(run, database)?;
    }
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

/// Refuses the name of a queue for a run in a folder, whose workers keep it there.
fn refuse_needless_queue(run: &Path, asked: &RunsQueue) -> Result<(), CommandError> {
    let Some(queue) = asked.queue.as_ref().filter(|_| store_address(run).is_none()) else { return Ok(()) };
    if ChunkHandout::from_folder(run)? == Some(ChunkHandout::Queue(queue.clone())) {
        return Ok(());
    }
    Err(CommandError::usage(
        "--queue names the queue of a run in an object store",
        "leave it out: a run in a folder names its own",
    ))
}

/// Refuses a folder that is not there, and a run that one machine made or makes: it has no chunks.
fn refuse_single_run(run: &Path) -> Result<(), CommandError> {
    // An address in an object store is no folder of this machine.
    if !run.exists() && store_address(run).is_none() {
        return Err(CommandError::usage(
            format!("{}: there is no such folder", run.display()),
            "give the --out folder of the run",
        ));
    }
    if !is_begun(run) || ChunkPlan::find_plan(run)?.is_some() {
        return Ok(());
    }
    let problem = format!("{}: one machine makes this run, and it has no chunks", run.display());
    Err(CommandError::usage(
        problem,
        "the command that began it continues it; `wayword report --run` shows what is there",
    ))
}

//! `wayword runs`: looks after a run that many workers make.

mod database;
mod merge;
mod prometheus;
mod retry;
mod status;

use crate::{
    cli::{Runs, RunsCommand},
    error::{Error, Exit},
    output::Output,
};

pub(super) fn run(args: &Runs, output: &Output) -> Result<Exit, Error> {
    match &args.command {
        RunsCommand::Status(args) => status::run(args, output),
        RunsCommand::Merge(args) => merge::run(args, output),
        RunsCommand::Retry(args) => retry::run(args, output),
        RunsCommand::Database(args) => database::run(args, output),
    }
}

//! `wayword runs`: shows, merges and retries a run that many workers make.

pub mod args;
mod database;
mod merge;
mod prometheus;
mod retry;
mod status;

use crate::runs::args::{Runs, RunsCommand};
use wayword_run::{
    error::{Error, Exit},
    output::Output,
};

pub fn run(args: &Runs, output: &Output) -> Result<Exit, Error> {
    match &args.command {
        RunsCommand::Status(args) => status::run(args, output),
        RunsCommand::Merge(args) => merge::run(args, output),
        RunsCommand::Retry(args) => retry::run(args, output),
        RunsCommand::Database(args) => database::run(args, output),
    }
}

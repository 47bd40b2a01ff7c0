//! `wayword runs retry`: opens chunks again.

use super::status::queue_of;
use crate::{
    cli::RunsRetry,
    count::count,
    error::{Error, Exit},
    output::Output,
};
use serde::Serialize;
use wayword_queue::{Plan, reopen};

#[derive(Serialize)]
struct Opened {
    run: String,
    chunks: Vec<usize>,
}

pub(super) fn run(args: &RunsRetry, output: &Output) -> Result<Exit, Error> {
    let plan = Plan::of(&args.run)?;
    let chunks = match queue_of(&args.run, &plan, args.password_env.as_deref())? {
        None => reopen(&args.run, &plan, &args.reason)?,
        #[cfg(feature = "queue")]
        Some(queue) => queue.retry(&plan, &args.reason)?,
        #[cfg(not(feature = "queue"))]
        Some(never) => match never {},
    };
    let told = match chunks.len() {
        0 => format!("no chunk has a failure with the words {:?}", args.reason),
        opened => format!("{} opened again: start workers with the same command as before", count(opened, "chunk")),
    };
    output.data(&Opened { run: args.run.display().to_string(), chunks }, told);
    Ok(Exit::Done)
}

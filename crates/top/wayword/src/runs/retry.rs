//! `wayword runs retry`: opens chunks again that failed for a given reason, so that workers make them again.

use super::status::queue_of;
use crate::runs::args::RunsRetry;
use serde::Serialize;
use wayword_queue::{Plan, failing, reopen};
use wayword_run::{
    count::count,
    error::{Error, Exit},
    output::Output,
    stores::RunPlace,
};

#[derive(Serialize)]
struct Opened {
    run: String,
    chunks: Vec<usize>,
}

pub fn run(args: &RunsRetry, output: &Output) -> Result<Exit, Error> {
    let place = RunPlace::of(&args.run)?;
    let (folder, plan) = (place.folder(), Plan::of(place.folder())?);
    place.fetch_marks(&plan)?;
    let chunks = match queue_of(&place, &plan, &args.database)? {
        None => {
            let chunks = failing(folder, &plan, &args.reason)?;
            place.reopen(&chunks)?;
            reopen(folder, &chunks)?;
            chunks
        }
        #[cfg(feature = "queue")]
        Some(queue) => {
            queue.mark()?;
            let chunks = queue.failing(&plan, &args.reason)?;
            // If this ends here, the queue's workers send the marks again, and the chunks stay finished.
            place.reopen(&chunks)?;
            queue.reopen(&chunks)?;
            chunks
        }
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

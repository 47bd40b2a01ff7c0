//! `wayword runs retry`: opens chunks again that failed for a given reason, so that workers make them again.

use super::status::queue_of;
use crate::runs::args::RunsRetry;
use serde::Serialize;
use wayword_queue::{ChunkPlan, failing_chunks, reopen_chunks};
use wayword_run::{
    count::count_phrase,
    error::{CommandError, Exit},
    output::CommandOutput,
    stores::RunPlace,
};

/// The chunks that were opened again.
#[derive(Serialize)]
struct RetrySummary {
    run: String,
    chunks: Vec<usize>,
}

/// Runs `wayword runs retry`, on the files of a shared folder or on the database of a queue.
pub(super) fn run_retry(args: &RunsRetry, output: &CommandOutput) -> Result<Exit, CommandError> {
    let place = RunPlace::open_named(&args.run)?;
    let (folder, plan) = (place.folder(), ChunkPlan::for_folder(place.folder())?);
    place.fetch_marks(&plan)?;
    let chunks = match queue_of(&place, &plan, &args.database)? {
        None => {
            let chunks = failing_chunks(folder, &plan, &args.reason)?;
            place.reopen_chunks(&chunks)?;
            reopen_chunks(folder, &chunks)?;
            chunks
        }
        #[cfg(feature = "queue")]
        Some(queue) => {
            queue.write_missing_marks()?;
            let chunks = queue.failing_chunks(&plan, &args.reason)?;
            // If this ends here, the queue's workers send the marks again, and the chunks stay finished.
            place.reopen_chunks(&chunks)?;
            queue.reopen_chunks(&chunks)?;
            chunks
        }
        #[cfg(not(feature = "queue"))]
        Some(never) => match never {},
    };
    let text = match chunks.len() {
        0 => format!("no chunk has a failure with the words {:?}", args.reason),
        opened => {
            format!("{} opened again: start workers with the same command as before", count_phrase(opened, "chunk"))
        }
    };
    output.print_result(&RetrySummary { run: args.run.display().to_string(), chunks }, text);
    Ok(Exit::Done)
}

//! `wayword runs retry`: opens chunks again that failed for a given reason, or whose files are damaged, so that workers make them
//! again.

use super::status::queue_of;
use crate::runs::args::RunsRetry;
use serde::Serialize;
use std::path::Path;
use wayword_queue::{ChunkPlan, CompareDepth, failing_chunks, read_done_mark, reopen_chunks, set_files_aside};
use wayword_run::{
    count::count_phrase,
    error::{CommandError, Exit},
    generate::{CHUNK_FILES, ChunkChecker},
    output::CommandOutput,
    stores::RunPlace,
};

/// The chunks that were opened again.
#[derive(Serialize)]
struct RetrySummary {
    run: String,
    chunks: Vec<usize>,
    /// Where the old files of chunks that are made anew are.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    set_aside: Vec<String>,
}

/// Runs `wayword runs retry`, on the files of a shared folder or on the database of a queue.
pub(super) fn run_retry(args: &RunsRetry, output: &CommandOutput) -> Result<Exit, CommandError> {
    let place = RunPlace::open_named(&args.run)?;
    let (folder, plan) = (place.folder(), ChunkPlan::for_folder(place.folder())?);
    place.fetch_marks(&plan)?;
    let named = named_chunks(args, &place, &plan, output)?;
    let reason = args.reason.as_deref().unwrap_or_default();
    let mut set_aside = Vec::new();
    let chunks = match queue_of(&place, &plan, &args.database)? {
        None => {
            let chunks = named.map_or_else(|| failing_chunks(folder, &plan, reason), Ok)?;
            if args.reason.is_none() && !place.is_stored() {
                // Before the marks go: a worker must not continue damaged files.
                set_aside = set_chunks_aside(folder, &chunks)?;
            }
            place.reopen_chunks(&chunks)?;
            reopen_chunks(folder, &chunks)?;
            chunks
        }
        #[cfg(feature = "queue")]
        Some(queue) => {
            queue.write_missing_marks()?;
            let chunks = named.map_or_else(|| queue.failing_chunks(&plan, reason), Ok)?;
            // If this ends here, the queue's workers send the marks again, and the chunks stay finished.
            place.reopen_chunks(&chunks)?;
            queue.reopen_chunks(&chunks)?;
            chunks
        }
        #[cfg(not(feature = "queue"))]
        Some(never) => match never {},
    };
    let text = match (chunks.len(), &args.reason) {
        (0, Some(reason)) => format!("no chunk has a failure with the words {reason:?}"),
        (0, None) => "no finished chunk is damaged".to_owned(),
        (opened, _) => {
            format!("{} opened again: start workers with the same command as before", count_phrase(opened, "chunk"))
        }
    };
    output.print_result(&RetrySummary { run: args.run.display().to_string(), chunks, set_aside }, text);
    Ok(Exit::Done)
}

/// The chunks that are to be made anew; `None` if a reason names them.
fn named_chunks(
    args: &RunsRetry,
    place: &RunPlace,
    plan: &ChunkPlan,
    output: &CommandOutput,
) -> Result<Option<Vec<usize>>, CommandError> {
    if !args.chunk.is_empty() {
        let last = plan.chunk_count().saturating_sub(1);
        return match args.chunk.iter().find(|chunk| **chunk > last) {
            Some(beyond) => Err(CommandError::usage(
                format!("--chunk {beyond}: {} has the chunks 0 to {last}", args.run.display()),
                "give numbers as `wayword runs status` shows them",
            )),
            None => Ok(Some(args.chunk.clone())),
        };
    }
    if !args.damaged {
        return Ok(None);
    }
    if place.is_stored() {
        return Err(CommandError::usage(
            "--damaged cannot look at the files of a run in an object store",
            "merge it into a folder (`wayword runs merge ADDRESS --to DIR`), which names the damaged chunks, and give their \
             numbers with --chunk",
        ));
    }
    let bar = output.progress_bar(plan.chunk_count(), "chunks");
    let checked = ChunkChecker::new(place.folder(), plan, CompareDepth::Everything).check_chunks(|| bar.inc(1));
    bar.finish_and_clear();
    Ok(Some(checked?.damaged_chunks().into_iter().collect()))
}

/// Moves the files of chunks out of the way. Tries of a queue have folders of their own, and are left where they are. The answers of
/// models stay with the chunk, so that they are not paid for again.
fn set_chunks_aside(folder: &Path, chunks: &[usize]) -> Result<Vec<String>, CommandError> {
    let mut set_aside = Vec::new();
    for chunk in chunks {
        // A mark that cannot be read is one of a chunk that is made anew.
        let is_of_queue = read_done_mark(folder, *chunk).ok().flatten().is_some_and(|done| done.epoch > 0);
        if !is_of_queue {
            set_aside.push(set_files_aside(folder, *chunk, 0, &CHUNK_FILES)?.display().to_string());
        }
    }
    Ok(set_aside)
}

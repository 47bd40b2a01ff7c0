//! Makes one chunk of a run, in a run folder of its own.

use super::{WorkerStop, board::recording_path, chunk_check::CHUNK_FILES};
use crate::{
    count::count_phrase,
    error::{CommandError, Exit},
    generate::fill::ItemWorkshop,
    output::CommandOutput,
    run_folder::{FailedItem, RunFolder, WorldData, file, read_lines},
};
use std::{
    collections::BTreeMap,
    path::Path,
    time::{Instant, SystemTime, UNIX_EPOCH},
};
use wayword_queue::{ChunkClaim, ChunkOutcome, ChunkPlan, ChunkRecord, chunk_folder, mark_files, sync_tree};

/// Longest reason of a failure that a completion mark keeps, characters. The rest is cut off; `errors.jsonl` has all of
/// it.
const MAX_REASON_CHARS: usize = 200;

/// Makes a claimed chunk. The outcome is done, with the completion mark; stopped, through no fault of the chunk; or
/// failed.
pub(super) fn make_chunk(
    out: &Path,
    plan: &ChunkPlan,
    shop: &ItemWorkshop<'_>,
    claimed: ChunkClaim,
    worker: &str,
    output: &CommandOutput,
) -> Result<ChunkOutcome<WorkerStop>, CommandError> {
    let (since, before) = (Instant::now(), usd_so_far(shop));
    let folder = chunk_folder(out, claimed.chunk, claimed.epoch);
    match fill_chunk(&folder, out, plan, shop, claimed, output) {
        Ok(None) => {
            let spent = ChunkCost { seconds: since.elapsed().as_secs_f64(), usd: usd_so_far(shop) - before };
            let done = ChunkRecord { worker: worker.to_owned(), ..completion_mark(&folder, plan, claimed, spent)? };
            output.say(format_args!(
                "chunk {} of {}: {}, {} written, {} rejected{}",
                claimed.chunk,
                plan.chunk_count(),
                count_phrase(plan.chunk_range(claimed.chunk).len(), "item"),
                done.written,
                done.rejected,
                if done.failed.is_empty() { String::new() } else { format!(", {} failed", done.failed_items()) }
            ));
            Ok(ChunkOutcome::Done(done))
        }
        Ok(Some(why)) if why.exit == Exit::Lost => Ok(ChunkOutcome::Failed(why.reason.clone(), why)),
        Ok(Some(why)) => Ok(ChunkOutcome::Stopped(why)),
        // A full disk or a lost database is not the fault of the chunk, so it is handed back.
        Err(error) => {
            let why = WorkerStop { reason: error.to_string(), exit: error.exit_code() };
            match why.exit {
                Exit::Lost | Exit::Stopped | Exit::Interrupted => Ok(ChunkOutcome::Stopped(why)),
                _ => Ok(ChunkOutcome::Failed(why.reason.clone(), why)),
            }
        }
    }
}

/// Makes the chunk's items. Returns the reason if it stopped early.
fn fill_chunk(
    folder: &Path,
    out: &Path,
    plan: &ChunkPlan,
    shop: &ItemWorkshop<'_>,
    claimed: ChunkClaim,
    output: &CommandOutput,
) -> Result<Option<WorkerStop>, CommandError> {
    let items = shop.plan.items.get(plan.chunk_range(claimed.chunk)).unwrap_or_default();
    let mut run = RunFolder::open_for_chunk(folder, shop.settings)?;
    if let Some(calls) = shop.calls {
        calls.turn_to(&recording_path(folder))?;
    }
    let data = WorldData::from_folder(folder)?.with_planned_hashes(&plan.data, &out.join(wayword_queue::PLAN));
    let stopped = shop.fill_folder(&mut run, &data, items, output)?;
    drop(run);
    match stopped {
        Some(stop) => Ok(Some(WorkerStop { reason: stop.reason, exit: stop.exit })),
        None => Ok(sync_tree(folder).map(|()| None)?),
    }
}

/// The time and money that a chunk took.
struct ChunkCost {
    seconds: f64,
    usd: f64,
}

/// US dollars that this worker's calls have cost so far.
fn usd_so_far(shop: &ItemWorkshop<'_>) -> f64 {
    shop.calls.map_or(0.0, |calls| calls.spent_so_far().usd)
}

/// The completion mark of a chunk, counted from the files in its folder.
fn completion_mark(
    folder: &Path,
    plan: &ChunkPlan,
    claimed: ChunkClaim,
    ChunkCost { seconds, usd }: ChunkCost,
) -> Result<ChunkRecord, CommandError> {
    let files = mark_files(folder, &CHUNK_FILES)?;
    let lines = |name: &str| files.get(name).map_or(0, |mark| usize::try_from(mark.count).unwrap_or(usize::MAX));
    let mut failed: BTreeMap<String, usize> = BTreeMap::new();
    for FailedItem { reason, .. } in read_lines(&folder.join(file::ERRORS))? {
        *failed.entry(reason.chars().take(MAX_REASON_CHARS).collect()).or_default() += 1;
    }
    let at_unix_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    Ok(ChunkRecord {
        chunk: claimed.chunk,
        epoch: claimed.epoch,
        made: lines(file::WALKS),
        written: lines(file::INSTRUCTIONS),
        rejected: lines(file::REJECTED),
        failed,
        seconds,
        usd,
        at_unix_s,
        run: plan.run.clone(),
        files,
        ..ChunkRecord::default()
    })
}

//! Makes one chunk of a run, in a run folder of its own.

use super::{Why, board::calls_of};
use crate::{
    count::count,
    error::{Error, Exit},
    generate::fill::Workshop,
    output::Output,
    run_folder::{FailedItem, RunFolder, WorldData, file, read_lines},
};
use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    time::{Instant, SystemTime, UNIX_EPOCH},
};
use wayword_queue::{Claimed, Done, Ended, Plan, chunk_folder, sync_tree};

/// Longest reason of a failure that a mark keeps, characters.
const MOST_REASON_CHARS: usize = 200;

pub(super) fn make(
    out: &Path,
    plan: &Plan,
    shop: &Workshop<'_>,
    claimed: Claimed,
    worker: &str,
    output: &Output,
) -> Result<Ended<Why>, Error> {
    let (since, before) = (Instant::now(), usd(shop));
    let folder = chunk_folder(out, claimed.chunk, claimed.epoch);
    match fill(&folder, out, plan, shop, claimed, output) {
        Ok(None) => {
            let spent = Spent { seconds: since.elapsed().as_secs_f64(), usd: usd(shop) - before };
            let done = Done { worker: worker.to_owned(), ..done(&folder, claimed, spent)? };
            output.say(format_args!(
                "chunk {} of {}: {}, {} written, {} rejected{}",
                claimed.chunk,
                plan.chunks(),
                count(plan.range(claimed.chunk).len(), "item"),
                done.written,
                done.rejected,
                if done.failed.is_empty() { String::new() } else { format!(", {} failed", done.failures()) }
            ));
            Ok(Ended::Done(done))
        }
        Ok(Some(why)) if why.exit == Exit::Lost => Ok(Ended::Failed(why.reason.clone(), why)),
        Ok(Some(why)) => Ok(Ended::Stopped(why)),
        // A full disk or a lost database is not the fault of the chunk, so it is handed back.
        Err(error) => {
            let why = Why { reason: error.to_string(), exit: error.exit_code() };
            match why.exit {
                Exit::Lost | Exit::Stopped | Exit::Interrupted => Ok(Ended::Stopped(why)),
                _ => Ok(Ended::Failed(why.reason.clone(), why)),
            }
        }
    }
}

/// Makes the chunk's items. Returns the reason if it stopped early.
fn fill(
    folder: &Path,
    out: &Path,
    plan: &Plan,
    shop: &Workshop<'_>,
    claimed: Claimed,
    output: &Output,
) -> Result<Option<Why>, Error> {
    let items = shop.plan.items.get(plan.range(claimed.chunk)).unwrap_or_default();
    let mut run = RunFolder::of_worker(folder, shop.settings)?;
    if let Some(calls) = shop.calls {
        calls.turn_to(&calls_of(folder))?;
    }
    let data = WorldData::of(folder)?.expecting(&plan.data, &out.join(wayword_queue::PLAN));
    let stopped = shop.fill(&mut run, &data, items, output)?;
    drop(run);
    match stopped {
        Some(stop) => Ok(Some(Why { reason: stop.reason, exit: stop.exit })),
        None => Ok(sync_tree(folder).map(|()| None)?),
    }
}

/// The time and money that a chunk took.
struct Spent {
    seconds: f64,
    usd: f64,
}

/// US dollars that this worker's calls have cost so far.
fn usd(shop: &Workshop<'_>) -> f64 {
    shop.calls.map_or(0.0, |calls| calls.spent().usd)
}

fn done(folder: &Path, claimed: Claimed, Spent { seconds, usd }: Spent) -> Result<Done, Error> {
    let lines = |name: &str| -> Result<usize, Error> {
        let path = folder.join(name);
        let text = fs::read(&path).map_err(Error::io(&path, "count the lines of"))?;
        Ok(text.iter().filter(|byte| **byte == b'\n').count())
    };
    let mut failed: BTreeMap<String, usize> = BTreeMap::new();
    for FailedItem { reason, .. } in read_lines(&folder.join(file::ERRORS))? {
        *failed.entry(reason.chars().take(MOST_REASON_CHARS).collect()).or_default() += 1;
    }
    let at_unix_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    Ok(Done {
        chunk: claimed.chunk,
        epoch: claimed.epoch,
        made: lines(file::WALKS)?,
        written: lines(file::INSTRUCTIONS)?,
        rejected: lines(file::REJECTED)?,
        failed,
        seconds,
        usd,
        at_unix_s,
        ..Done::default()
    })
}

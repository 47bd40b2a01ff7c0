//! The results that a worker prints: a summary of the plan (`--plan`), and a summary of its own work.

use super::Why;
use crate::{
    calls::Spent,
    count::count,
    error::{Error, Exit},
    stores::RunPlace,
};
use serde::Serialize;
use std::{fmt, path::Path};
use wayword_queue::{Done, Finished, Plan, done_path};

/// A plan, for people and machines.
#[derive(Serialize)]
pub(super) struct Planned {
    run: String,
    items: usize,
    chunks: usize,
    chunk: usize,
    estimate: serde_json::Value,
}

impl Planned {
    pub(super) fn of(out: &Path, plan: &Plan) -> Self {
        Self {
            run: out.display().to_string(),
            items: plan.items.len(),
            chunks: plan.chunks(),
            chunk: plan.chunk,
            estimate: plan.estimate.clone(),
        }
    }
}

impl fmt::Display for Planned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { run, items, chunks, chunk, .. } = self;
        writeln!(f, "{run}: {} in {} of {chunk}", count(*items, "item"), count(*chunks, "chunk"))?;
        write!(f, "workers make them with the same command and --shard K/N or --queue DATABASE instead of --plan")
    }
}

/// The work of one worker.
#[derive(Serialize)]
pub(super) struct Worked {
    run: String,
    /// Chunks that this worker finished.
    chunks: usize,
    /// Chunks of the whole run that are not finished.
    unfinished: usize,
    items: usize,
    written: usize,
    rejected: usize,
    failed: usize,
    /// Finished chunks that were dropped, because another worker had taken them over.
    dropped: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    spent: Option<Spent>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stopped: Option<String>,
    #[serde(skip)]
    pub(super) exit: Exit,
}

impl Worked {
    pub(super) fn of(
        place: &RunPlace,
        plan: &Plan,
        finished: Finished<Why>,
        spent: Option<Spent>,
    ) -> Result<Self, Error> {
        let Finished { done, dropped, stopped } = finished;
        let sum = |of: fn(&Done) -> usize| done.iter().map(of).sum();
        let failed = sum(Done::failures);
        let made: usize = sum(|done| done.made);
        Ok(Self {
            run: place.named().display().to_string(),
            chunks: done.len(),
            unfinished: (0..plan.chunks()).filter(|chunk| !done_path(place.folder(), *chunk).exists()).count(),
            items: made + failed,
            written: sum(|done| done.written),
            rejected: sum(|done| done.rejected),
            failed,
            dropped,
            spent,
            exit: stopped.as_ref().map_or(Exit::Done, |why| why.exit),
            stopped: stopped.map(|why| why.reason),
        })
    }
}

impl fmt::Display for Worked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: this worker made {} ({}): {} written, {} rejected, {} failed",
            self.run,
            count(self.chunks, "chunk"),
            count(self.items, "item"),
            self.written,
            self.rejected,
            self.failed
        )?;
        if self.dropped > 0 {
            write!(f, "; {} dropped, because another worker had taken over", count(self.dropped, "chunk"))?;
        }
        if let Some(spent) = &self.spent {
            write!(f, "\n{spent}")?;
        }
        match (&self.stopped, self.unfinished) {
            (Some(reason), _) => write!(f, "\nstopped: {reason}"),
            (None, 0) => write!(
                f,
                "\nevery chunk of the run is finished: put them together with `wayword runs merge {}`",
                self.run
            ),
            (None, unfinished) => {
                let unfinished = count(unfinished, "chunk");
                write!(
                    f,
                    "\nnothing is left for this worker; {unfinished} of the run not finished: see `wayword runs status {}`",
                    self.run
                )
            }
        }
    }
}

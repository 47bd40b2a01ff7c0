//! The results that a worker prints: a summary of the plan (`--plan`), and a summary of its own work.

use super::WorkerStop;
use crate::{
    calls::CallSpending,
    count::count_phrase,
    error::{CommandError, Exit},
    stores::RunPlace,
};
use serde::Serialize;
use std::{fmt, path::Path};
use wayword_queue::{ChunkPlan, ChunkRecord, WorkSummary, done_path};

/// A plan, for people and machines.
#[derive(Serialize)]
pub(super) struct PlanSummary {
    run: String,
    items: usize,
    chunks: usize,
    /// Items in a chunk.
    chunk: usize,
    estimate: serde_json::Value,
}

impl PlanSummary {
    pub(super) fn from_plan(out: &Path, plan: &ChunkPlan) -> Self {
        Self {
            run: out.display().to_string(),
            items: plan.items.len(),
            chunks: plan.chunk_count(),
            chunk: plan.chunk,
            estimate: plan.estimate.clone(),
        }
    }
}

impl fmt::Display for PlanSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { run, items, chunks, chunk, .. } = self;
        writeln!(f, "{run}: {} in {} of {chunk}", count_phrase(*items, "item"), count_phrase(*chunks, "chunk"))?;
        writeln!(f, "workers make them with the same command and --shard K/N or --queue DATABASE instead of --plan")?;
        write!(
            f,
            "at most {} have work at the same time; a smaller --chunk gives more of them work",
            count_phrase(*chunks, "worker")
        )
    }
}

/// The work of one worker.
#[derive(Serialize)]
pub(super) struct WorkerSummary {
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
    spent: Option<CallSpending>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stopped: Option<String>,
    #[serde(skip)]
    pub(super) exit: Exit,
}

impl WorkerSummary {
    pub(super) fn from_finished(
        place: &RunPlace,
        plan: &ChunkPlan,
        finished: WorkSummary<WorkerStop>,
        spent: Option<CallSpending>,
    ) -> Result<Self, CommandError> {
        let WorkSummary { done, dropped, stopped } = finished;
        let sum = |count: fn(&ChunkRecord) -> usize| done.iter().map(count).sum();
        let failed = sum(ChunkRecord::failed_items);
        let made: usize = sum(|done| done.made);
        Ok(Self {
            run: place.shown_path().display().to_string(),
            chunks: done.len(),
            unfinished: (0..plan.chunk_count()).filter(|chunk| !done_path(place.folder(), *chunk).exists()).count(),
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

impl fmt::Display for WorkerSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: this worker made {} ({}): {} written, {} rejected, {} failed",
            self.run,
            count_phrase(self.chunks, "chunk"),
            count_phrase(self.items, "item"),
            self.written,
            self.rejected,
            self.failed
        )?;
        if self.dropped > 0 {
            write!(f, "; {} dropped, because another worker had taken over", count_phrase(self.dropped, "chunk"))?;
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
                let unfinished = count_phrase(unfinished, "chunk");
                write!(
                    f,
                    "\nnothing is left for this worker; {unfinished} of the run not finished: see `wayword runs status {}`",
                    self.run
                )
            }
        }
    }
}

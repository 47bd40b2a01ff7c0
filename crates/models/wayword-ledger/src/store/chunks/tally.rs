//! Sums up the requests and the spending of each run over the entries of a chunk's file.

use super::line::ChunkEntry;
use crate::{RunSpending, budget::SpentBudget, store::RequestEnd};
use std::collections::BTreeMap;

/// The sums over the entries of a file.
#[derive(Debug, Default)]
pub(super) struct ChunkTally {
    runs: BTreeMap<String, RunSums>,
    /// Requests without a known end: they are in flight, or were when a program was killed.
    open: BTreeMap<i64, OpenRequest>,
    /// The highest number of a request.
    last: i64,
}

/// A request without a known end.
#[derive(Debug)]
struct OpenRequest {
    run: String,
    /// The most that it may cost, US dollars.
    most_usd: Option<f64>,
}

/// The sums of one run.
#[derive(Debug, Default)]
struct RunSums {
    /// The requests with a known end, and what they cost.
    known: RunSpending,
    /// The amount that counts against the run's limit, US dollars. An answer without a price counts at its upper bound.
    against_usd: f64,
}

impl ChunkTally {
    /// Counts an entry.
    pub(super) fn count_entry(&mut self, entry: &ChunkEntry) {
        match entry {
            ChunkEntry::Ledger { .. } => {}
            ChunkEntry::Sent { number, run, most_usd, .. } => {
                self.last = self.last.max(*number);
                self.runs.entry(run.clone()).or_default().known.requests += 1;
                self.open.insert(*number, OpenRequest { run: run.clone(), most_usd: *most_usd });
            }
            ChunkEntry::Ended { number, outcome, .. } => self.count_end(*number, *outcome),
            ChunkEntry::Answered { number, row } => {
                let open = number.and_then(|number| self.open.remove(&number));
                let sums = self.runs.entry(row.run.clone()).or_default();
                sums.known.answered += 1;
                sums.known.usd += row.answer.usd.unwrap_or(0.0);
                sums.against_usd += row.answer.usd.or(open.and_then(|open| open.most_usd)).unwrap_or(0.0);
            }
        }
    }

    /// Counts the end of a request that brought no answer.
    fn count_end(&mut self, number: i64, end: RequestEnd) {
        let Some(open) = self.open.remove(&number) else { return };
        let sums = self.runs.entry(open.run).or_default();
        match end {
            RequestEnd::Cancelled => sums.known.requests = sums.known.requests.saturating_sub(1),
            RequestEnd::Failed => {}
            RequestEnd::Lost => {
                let usd = open.most_usd.unwrap_or(0.0);
                sums.known.lost += 1;
                sums.known.maybe_usd += usd;
                sums.against_usd += usd;
            }
        }
    }

    /// The number of the next request.
    pub(super) fn next_number(&self) -> i64 {
        self.last.saturating_add(1)
    }

    /// The spending of a run that counts against its limits.
    pub(super) fn spent_by_run(&self, run: &str) -> SpentBudget {
        let sums = self.runs.get(run);
        let open = self.open.values().filter(|open| open.run == run);
        SpentBudget {
            usd: sums.map_or(0.0, |sums| sums.against_usd),
            reserved_usd: open.map(|open| open.most_usd.unwrap_or(0.0)).sum(),
            calls: sums.map_or(0, |sums| sums.known.requests),
        }
    }

    /// The spending of a run, or of all runs.
    pub(super) fn spending_by_run(&self, run: Option<&str>) -> RunSpending {
        let is_counted = |name: &str| run.is_none_or(|run| run == name);
        let runs = self.runs.iter().filter(|(name, _)| is_counted(name)).map(|(_, sums)| sums.known);
        let mut all = runs.fold(RunSpending::default(), RunSpending::plus);
        for open in self.open.values().filter(|open| is_counted(&open.run)) {
            all.lost += 1;
            all.maybe_usd += open.most_usd.unwrap_or(0.0);
        }
        all
    }
}

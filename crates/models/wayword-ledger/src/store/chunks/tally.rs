//! Sums up the requests and the spending of each run over the entries of a chunk's file.

use super::line::Entry;
use crate::{Spending, budget::Spent, store::End};
use std::collections::BTreeMap;

/// The sums over the entries of a file.
#[derive(Debug, Default)]
pub(super) struct Tally {
    runs: BTreeMap<String, Sums>,
    /// Requests without a known end: they are in flight, or were when a program was killed.
    open: BTreeMap<i64, Open>,
    /// The highest number of a request.
    last: i64,
}

#[derive(Debug)]
struct Open {
    run: String,
    most_usd: Option<f64>,
}

#[derive(Debug, Default)]
struct Sums {
    known: Spending,
    /// The amount that counts against the run's limit. An answer without a price counts at its upper bound.
    against_usd: f64,
}

impl Tally {
    /// Counts an entry.
    pub(super) fn take(&mut self, entry: &Entry) {
        match entry {
            Entry::Ledger { .. } => {}
            Entry::Sent { number, run, most_usd, .. } => {
                self.last = self.last.max(*number);
                self.runs.entry(run.clone()).or_default().known.requests += 1;
                self.open.insert(*number, Open { run: run.clone(), most_usd: *most_usd });
            }
            Entry::Ended { number, outcome, .. } => self.ended(*number, *outcome),
            Entry::Answered { number, row } => {
                let open = number.and_then(|number| self.open.remove(&number));
                let sums = self.runs.entry(row.run.clone()).or_default();
                sums.known.answered += 1;
                sums.known.usd += row.answer.usd.unwrap_or(0.0);
                sums.against_usd += row.answer.usd.or(open.and_then(|open| open.most_usd)).unwrap_or(0.0);
            }
        }
    }

    fn ended(&mut self, number: i64, end: End) {
        let Some(open) = self.open.remove(&number) else { return };
        let sums = self.runs.entry(open.run).or_default();
        match end {
            End::Cancelled => sums.known.requests = sums.known.requests.saturating_sub(1),
            End::Failed => {}
            End::Lost => {
                let usd = open.most_usd.unwrap_or(0.0);
                sums.known.lost += 1;
                sums.known.maybe_usd += usd;
                sums.against_usd += usd;
            }
        }
    }

    /// The number of the next request.
    pub(super) fn next(&self) -> i64 {
        self.last.saturating_add(1)
    }

    /// The spending of a run that counts against its limits.
    pub(super) fn spent(&self, run: &str) -> Spent {
        let sums = self.runs.get(run);
        let open = self.open.values().filter(|open| open.run == run);
        Spent {
            usd: sums.map_or(0.0, |sums| sums.against_usd),
            reserved_usd: open.map(|open| open.most_usd.unwrap_or(0.0)).sum(),
            calls: sums.map_or(0, |sums| sums.known.requests),
        }
    }

    /// The spending of a run, or of all runs.
    pub(super) fn spending(&self, run: Option<&str>) -> Spending {
        let is_of = |name: &str| run.is_none_or(|run| run == name);
        let runs = self.runs.iter().filter(|(name, _)| is_of(name)).map(|(_, sums)| sums.known);
        let mut all = runs.fold(Spending::default(), Spending::plus);
        for open in self.open.values().filter(|open| is_of(&open.run)) {
            all.lost += 1;
            all.maybe_usd += open.most_usd.unwrap_or(0.0);
        }
        all
    }
}

//! The parameters and results of queries to a ledger: which calls to select, and sums of costs.

use serde::Serialize;

/// Which calls to list, export or drop.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LedgerFilter {
    /// Only calls of this model.
    pub model: Option<String>,
    /// Only calls that this run has used.
    pub run: Option<String>,
    /// Only calls with an answer older than this, seconds.
    pub older_than_s: Option<u64>,
    /// At most this many, the latest ones. [`crate::Ledger::list_calls`] alone uses this.
    pub limit: Option<usize>,
}

/// How costs are grouped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CostGrouping {
    /// By model.
    Model,
    /// By the run that paid.
    Run,
    /// By day, UTC.
    Day,
}

/// The cost of a model, a run or a day.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CostLine {
    /// Name of the model or the run, or the day.
    pub of: String,
    /// Calls that were answered.
    pub calls: u64,
    /// Tokens of requests.
    pub tokens_in: u64,
    /// Tokens of answers.
    pub tokens_out: u64,
    /// US dollars, for the calls with a known price.
    pub usd: f64,
    /// Calls without a known price.
    pub without_price: u64,
}

/// The requests and the spending of a run in all its processes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct RunSpending {
    /// Requests that were sent.
    pub requests: u64,
    /// Requests that were answered.
    pub answered: u64,
    /// Requests without a known answer, which may have been paid for. Those in flight count.
    pub lost: u64,
    /// What the answers cost, US dollars, where the price is known.
    pub usd: f64,
    /// What the lost requests may have cost at most, US dollars.
    pub maybe_usd: f64,
}

impl RunSpending {
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            requests: self.requests.saturating_add(other.requests),
            answered: self.answered.saturating_add(other.answered),
            lost: self.lost.saturating_add(other.lost),
            usd: self.usd + other.usd,
            maybe_usd: self.maybe_usd + other.maybe_usd,
        }
    }
}

//! The stores of a ledger: the trait that all of them implement, and the types that they share.
//!
//! Architecture invariant: everything that a store reports as written survives the end of the program, and a loss of power too.

mod chunks;
mod commit_queue;
#[cfg(feature = "postgres")]
mod postgres;
mod sqlite;

use crate::{
    CallAnswer, CallKey, CostGrouping, CostLine, LedgerEntry, LedgerError, LedgerFilter, LedgerLocation, ProviderRates,
    RequestRefusedError, RunLimits, RunSpending, budget::SpentBudget,
};
use serde::{Deserialize, Serialize};
use std::{fmt, path::Path, time::Instant};

pub(crate) use chunks::{ChunkEntry, ChunkStore, spent_in};
#[cfg(feature = "postgres")]
pub use postgres::LEDGER_TABLES;
#[cfg(feature = "postgres")]
pub(crate) use postgres::{LeaseTiming, PostgresStore};
pub(crate) use sqlite::{SqliteStore, check_place};

/// Stores calls and requests, and enforces limits. Every function may be called by many threads at once.
pub(crate) trait CallStore: CallQueries + fmt::Debug + Send + Sync {
    /// The location of the store, for messages.
    fn ledger_location(&self) -> LedgerLocation;

    /// Goes on with the file of another chunk.
    fn turn_to(&self, _path: &Path) -> Result<(), LedgerError> {
        Err(LedgerError::Misuse { place: self.ledger_location(), reason: "this ledger has no chunks" })
    }

    /// The answer of a call, if it has one. Notes that the run has used it.
    fn find_answer(&self, key: &CallKey, run: &str) -> Result<Option<CallAnswer>, LedgerError>;

    /// Asks for the right to make a call. If the program `from` has it, takes it over, because that program is no longer waited for. A
    /// store with a single program always grants it.
    fn claim_call(&self, key: &CallKey, from: Option<&str>) -> Result<ClaimState, LedgerError>;

    /// Gives back the right to make a call. If this cannot be written now, it is written later.
    fn release_call(&self, key: &CallKey);

    /// The program that is making a call at the moment.
    fn claim_holder(&self, key: &CallKey) -> Result<Option<ClaimHolder>, LedgerError>;

    /// Writes a request down that is about to be sent, and returns its number. A store that keeps the budget also
    /// reserves its money, and refuses where a limit would be exceeded.
    fn write_request(&self, request: &PendingRequest<'_>) -> Result<i64, RequestRefusedError>;

    /// Writes down that a request brought no answer. If this cannot be written now, it is written later.
    fn write_end(&self, sent: &SentRequest, end: RequestEnd, reason: &str);

    /// Writes an answer, and returns whether it is the call's first one. Gives back the right to make the call. The
    /// program need not have had it.
    fn write_answer(&self, sent: Option<&SentRequest>, row: LedgerEntry) -> Result<bool, LedgerError>;

    /// Returns once everything that was to be written later is written.
    fn flush(&self) -> Result<(), LedgerError>;

    /// Whether the store itself enforces the limits of runs. It has to if several programs share a run, or a run has several files.
    fn keeps_budget(&self) -> bool {
        false
    }

    /// Whether the store keeps rates for all programs together.
    fn shares_rates(&self) -> bool {
        false
    }

    /// Takes the next turn to send a request to a provider; `None` if there is no rate to keep.
    fn next_slot(&self, _provider: &str, _rates: ProviderRates, _tokens: u64) -> Result<Option<SendSlot>, LedgerError> {
        Ok(None)
    }
}

/// Queries over the stored calls, and their removal.
pub(crate) trait CallQueries {
    /// The spending of a run that counts against its limits: the paid amounts, plus the upper bounds of requests that may have been
    /// paid.
    fn spent_budget(&self, run: &str) -> Result<SpentBudget, LedgerError>;

    /// The spending of a run so far, itemised.
    fn run_spending(&self, run: &str) -> Result<RunSpending, LedgerError>;

    /// Passes the calls of a filter to `take`.
    fn for_each_call(
        &self,
        filter: &LedgerFilter,
        order: CallOrder,
        take: &mut dyn FnMut(LedgerEntry) -> Result<(), LedgerError>,
    ) -> Result<(), LedgerError>;

    /// Drops the calls of a filter, and returns how many.
    fn prune_calls(&self, filter: &LedgerFilter) -> Result<usize, LedgerError>;

    /// Drops the answers that were changed, and returns how many.
    fn prune_changed(&self) -> Result<usize, LedgerError>;

    /// Whether there is an answer of a model at an address.
    fn has_answers_from(&self, model: &str, base_url: &str) -> Result<bool, LedgerError>;

    /// Sums up the costs of calls.
    fn sum_costs(&self, by: CostGrouping) -> Result<Vec<CostLine>, LedgerError>;

    /// How many requests have no known answer.
    fn count_lost_requests(&self) -> Result<u64, LedgerError>;
}

/// A request that is about to be sent.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PendingRequest<'a> {
    pub(crate) run: &'a str,
    pub(crate) key: &'a CallKey,
    /// The most that it may cost, US dollars.
    pub(crate) most_usd: Option<f64>,
    /// The time, seconds since 1970.
    pub(crate) at_unix_s: i64,
    /// The limits of the run, for a store that keeps the budget.
    pub(crate) limits: RunLimits,
}

/// A request that the store has written down.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SentRequest {
    /// Its number in the store.
    pub(crate) number: i64,
    /// Its upper bound, US dollars.
    pub(crate) most_usd: Option<f64>,
}

/// How a request without an answer ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum RequestEnd {
    /// It was not sent after all.
    Cancelled,
    /// It failed and costs nothing.
    Failed,
    /// It failed and may have been paid for.
    Lost,
}

impl RequestEnd {
    /// Its name in the store.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Cancelled => "cancelled",
            Self::Failed => "failed",
            Self::Lost => "lost",
        }
    }
}

/// The program that is making a call.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct ClaimHolder {
    /// The name of the program.
    pub(crate) name: String,
    /// How many requests it has sent for the call.
    pub(crate) sent: i64,
    /// Whether it has ended.
    pub(crate) is_gone: bool,
}

/// The time window in which a request may leave.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SendSlot {
    /// The earliest moment.
    pub(crate) from: Instant,
    /// The latest moment. A request that left later could leave together with too many others.
    pub(crate) until: Instant,
}

/// The result of a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ClaimState {
    /// This program has it.
    Ours,
    /// Another program has it.
    Others,
    /// The call was answered before.
    Answered,
}

/// An order of calls.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CallOrder {
    /// By their keys.
    Key,
    /// The latest first, at most as many as the filter's limit.
    Latest,
}

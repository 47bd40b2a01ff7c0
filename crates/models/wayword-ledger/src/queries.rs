//! Lists, exports, summarises and drops the calls of a ledger.

use crate::{
    LedgerError,
    call::LedgerEntry,
    ledger::Ledger,
    spending::{CostGrouping, CostLine, LedgerFilter, RunSpending},
    store::CallOrder,
};
use std::{io::Write, path::Path};

impl Ledger {
    /// Lists calls, the latest first.
    ///
    /// # Errors
    /// When the ledger cannot be read.
    pub fn list_calls(&self, filter: &LedgerFilter) -> Result<Vec<LedgerEntry>, LedgerError> {
        let mut rows = Vec::new();
        self.store().for_each_call(filter, CallOrder::Latest, &mut |row| {
            rows.push(row);
            Ok(())
        })?;
        Ok(rows)
    }

    /// Writes calls as JSON lines to `out`, which `place` names in errors, in the order of their keys. Returns how many.
    ///
    /// # Errors
    /// When the ledger cannot be read or the lines cannot be written.
    pub fn export_calls(&self, filter: &LedgerFilter, place: &Path, mut out: impl Write) -> Result<usize, LedgerError> {
        let failed = LedgerError::io_error(place, "write");
        let mut count = 0;
        self.store().for_each_call(filter, CallOrder::Key, &mut |row| {
            let mut line = serde_json::to_vec(&row).map_err(|error| failed(error.into()))?;
            line.push(b'\n');
            count += 1;
            out.write_all(&line).map_err(&failed)
        })?;
        Ok(count)
    }

    /// Drops calls, and returns how many. The ledger keeps what runs have spent.
    ///
    /// # Errors
    /// When the ledger cannot be written.
    pub fn prune_calls(&self, filter: &LedgerFilter) -> Result<usize, LedgerError> {
        self.store().prune_calls(filter)
    }

    /// Whether the ledger has any answer of a model at an address.
    ///
    /// # Errors
    /// When the ledger cannot be read.
    pub fn has_answers_from(&self, model: &str, base_url: &str) -> Result<bool, LedgerError> {
        self.store().has_answers_from(model, base_url)
    }

    /// Drops the answers that were changed after they were written, and returns how many. The ledger keeps what runs
    /// have spent.
    ///
    /// # Errors
    /// When the ledger cannot be read or written.
    pub fn prune_changed(&self) -> Result<usize, LedgerError> {
        self.store().prune_changed()
    }

    /// Sums up the costs of calls by model, run or day.
    ///
    /// # Errors
    /// When the ledger cannot be read.
    pub fn sum_costs(&self, by: CostGrouping) -> Result<Vec<CostLine>, LedgerError> {
        self.store().sum_costs(by)
    }

    /// The requests and the spending of a run in all its processes, on all machines that share the ledger.
    ///
    /// # Errors
    /// When the ledger cannot be read.
    pub fn run_spending(&self, run: &str) -> Result<RunSpending, LedgerError> {
        self.store().run_spending(run)
    }

    /// Counts the requests that were sent and have no known answer. They may have been paid for.
    ///
    /// # Errors
    /// When the ledger cannot be read.
    pub fn count_lost_requests(&self) -> Result<u64, LedgerError> {
        self.store().count_lost_requests()
    }
}

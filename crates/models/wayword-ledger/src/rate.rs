//! Rates of requests and tokens that all programs with the ledger open keep together.

use crate::{LedgerError, LedgerRun};
use std::{
    thread,
    time::{Duration, Instant},
};

/// How often a waiting thread checks whether it was stopped.
const LOOK_UP: Duration = Duration::from_millis(100);

/// How many turns in a row may be missed. If a request misses more, the database is too slow for a common rate.
const MOST_MISSED: usize = 100;

/// The rates for a provider that the user has set.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ProviderRates {
    /// Requests per second.
    pub requests_per_s: Option<f64>,
    /// Tokens per second, in and out.
    pub tokens_per_s: Option<f64>,
}

impl LedgerRun {
    /// Whether the ledger keeps rates for all programs together, see [`LedgerRun::wait_turn`].
    #[must_use]
    pub fn shares_rates(&self) -> bool {
        self.ledger().store().shares_rates()
    }

    /// Waits until a request of about so many tokens may be sent to a provider, if the ledger keeps rates for all
    /// programs together; otherwise returns at once. Returns false if `stopped` became true first.
    ///
    /// Requests leave in the order in which they asked. In any second, at most a tenth more than the rate leave, or one more where a
    /// tenth is less than one. A request that comes too late for its turn gives it up and takes another.
    ///
    /// # Errors
    /// When the ledger cannot be used, or answers too slowly.
    pub fn wait_turn(
        &self,
        provider: &str,
        rates: ProviderRates,
        tokens: u64,
        stopped: impl Fn() -> bool,
    ) -> Result<bool, LedgerError> {
        let store = self.ledger().store();
        for _ in 0..MOST_MISSED {
            if stopped() {
                return Ok(false);
            }
            let Some(slot) = store.next_slot(provider, rates, tokens)? else { return Ok(true) };
            if !wait_until(slot.from, &stopped) {
                return Ok(false);
            }
            if Instant::now() <= slot.until {
                return Ok(true);
            }
        }
        Err(LedgerError::Slow { place: store.ledger_location() })
    }
}

/// Waits until the moment `from`; returns false if `stopped` became true first.
fn wait_until(from: Instant, stopped: impl Fn() -> bool) -> bool {
    loop {
        match from.saturating_duration_since(Instant::now()) {
            Duration::ZERO => return true,
            _ if stopped() => return false,
            left => thread::sleep(left.min(LOOK_UP)),
        }
    }
}

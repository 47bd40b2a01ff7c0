//! Rates of requests and tokens that all programs with the ledger open keep together.

use std::{
    thread,
    time::{Duration, Instant},
};

/// A waiting thread checks at this interval whether it was stopped.
const STOP_CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// The rates for a provider that the user has set.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ProviderRates {
    /// Requests per second.
    pub requests_per_s: Option<f64>,
    /// Tokens per second, in and out.
    pub tokens_per_s: Option<f64>,
}

/// Waits until the moment `due`; returns false if `stopped` became true first.
pub(crate) fn wait_until(due: Instant, stopped: impl Fn() -> bool) -> bool {
    loop {
        match due.saturating_duration_since(Instant::now()) {
            Duration::ZERO => return true,
            _ if stopped() => return false,
            remaining => thread::sleep(remaining.min(STOP_CHECK_INTERVAL)),
        }
    }
}

//! The limits of a run on money and requests, and what it has spent against them.
//!
//! Before a request is sent, the most that it may cost is reserved. When it ends, the reservation is replaced by the real cost. So a limit
//! holds at every moment, with any number of requests in flight.

use crate::LedgerError;
use std::sync::{Mutex, PoisonError};

/// Limits of a run as a whole, including its earlier processes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RunLimits {
    /// The most that may be spent, US dollars; `None` for no limit.
    pub max_usd: Option<f64>,
    /// The most requests that may be sent; `None` for no limit.
    pub max_calls: Option<u64>,
}

/// Why a request may not be sent.
#[derive(Debug, Clone, thiserror::Error)]
pub enum RequestRefusedError {
    /// The user has interrupted.
    #[error("interrupted")]
    Stopped,
    /// The request could cost more than is left.
    #[error(
        "--max-usd {max_usd} could be exceeded: ${spent_usd:.4} are spent or reserved, and the next request may cost ${next_usd:.4}"
    )]
    MaxUsd {
        /// The limit, US dollars.
        max_usd: f64,
        /// The money that is spent, plus the reservations for requests in flight and for lost requests.
        spent_usd: f64,
        /// The most that the request may cost, US dollars.
        next_usd: f64,
    },
    /// The price of the request is not known, and there is a limit on money.
    #[error("--max-usd cannot be enforced: the price of this model is not known")]
    NoPrice,
    /// The run has sent as many requests as it may.
    #[error("--max-calls {max_calls} is reached")]
    MaxCalls {
        /// The limit.
        max_calls: u64,
    },
    /// The ledger cannot write the request down.
    #[error(transparent)]
    Ledger(#[from] LedgerError),
}

impl RequestRefusedError {
    /// Whether the ledger's disk is full or gone.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        matches!(self, Self::Ledger(error) if error.is_lost())
    }

    /// Splits the message into the reason and a hint at what to do.
    #[must_use]
    pub fn reason_and_hint(&self) -> (String, String) {
        let hint = match self {
            Self::MaxUsd { .. } => "all answers are kept: to continue, run the same command with a larger --max-usd",
            Self::MaxCalls { .. } => {
                "all answers are kept: to continue, run the same command with a larger --max-calls"
            }
            Self::NoPrice => "add the model's price to a file, and give the file with --prices FILE",
            Self::Stopped => "all answers are kept: to continue, run the same command",
            Self::Ledger(_) => "check the ledger, then run the same command to continue",
        };
        // An error of the ledger has its own hint.
        let text = self.to_string();
        let (reason, hint) = text.split_once("\nhint: ").unwrap_or((&text, hint));
        (reason.to_owned(), hint.to_owned())
    }
}

/// A run's limits, and what it has spent against them.
#[derive(Debug)]
pub(crate) struct RunBudget {
    limits: RunLimits,
    spent: Mutex<SpentBudget>,
}

/// What a run has spent of its limits so far.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SpentBudget {
    /// US dollars that were paid, or that lost requests may have cost.
    pub(crate) usd: f64,
    /// Upper bounds of the requests in flight, US dollars.
    pub(crate) reserved_usd: f64,
    /// Requests that were sent.
    pub(crate) calls: u64,
}

/// An amount of money, or `None` if it is negative or not finite, which a broken table of prices can cause.
pub(crate) fn valid_amount(usd: Option<f64>) -> Option<f64> {
    usd.filter(|usd| usd.is_finite() && *usd >= 0.0)
}

/// Tolerance, US dollars: rounding in a sum of many small amounts must not refuse the last request that fits.
const ROUNDING_USD: f64 = 1e-9;

/// Refuses a request that could exceed a limit. `most_usd` is the most that it may cost; `None` if its price is not known.
pub(crate) fn check_limits(
    limits: RunLimits,
    spent: SpentBudget,
    most_usd: Option<f64>,
) -> Result<(), RequestRefusedError> {
    if let Some(max_calls) = limits.max_calls.filter(|max_calls| spent.calls >= *max_calls) {
        return Err(RequestRefusedError::MaxCalls { max_calls });
    }
    let Some(max_usd) = limits.max_usd else { return Ok(()) };
    let Some(next_usd) = most_usd else { return Err(RequestRefusedError::NoPrice) };
    let spent_usd = spent.usd + spent.reserved_usd;
    // If the limit is not a number, the comparison is false, and every request is refused.
    let fits = spent_usd + next_usd <= max_usd + ROUNDING_USD;
    if fits { Ok(()) } else { Err(RequestRefusedError::MaxUsd { max_usd, spent_usd, next_usd }) }
}

impl RunBudget {
    pub(crate) fn new(limits: RunLimits, spent: SpentBudget) -> Self {
        Self { limits, spent: Mutex::new(spent) }
    }

    /// Reserves money for a request.
    pub(crate) fn reserve_money(&self, most_usd: Option<f64>) -> Result<(), RequestRefusedError> {
        let mut spent = self.spent.lock().unwrap_or_else(PoisonError::into_inner);
        check_limits(self.limits, *spent, most_usd)?;
        spent.reserved_usd += most_usd.unwrap_or(0.0);
        spent.calls += 1;
        Ok(())
    }

    /// Replaces a reservation with what the request cost.
    pub(crate) fn settle_reservation(&self, most_usd: Option<f64>, usd: f64) {
        let mut spent = self.spent.lock().unwrap_or_else(PoisonError::into_inner);
        spent.reserved_usd -= most_usd.unwrap_or(0.0);
        spent.usd += usd;
    }

    /// Takes back the reservation of a request that was not sent.
    pub(crate) fn cancel_reservation(&self, most_usd: Option<f64>) {
        self.settle_reservation(most_usd, 0.0);
        self.spent.lock().unwrap_or_else(PoisonError::into_inner).calls -= 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The limits hold at every moment, for any costs and any ends of the requests.
        #[test]
        fn the_bounds_hold(
            max_usd in 0.0..1.0f64,
            max_calls in 0u64..30,
            asked in prop::collection::vec((0.0..0.2f64, 0.0..1.0f64, any::<bool>()), 0..60),
        ) {
            let limits = RunLimits { max_usd: Some(max_usd), max_calls: Some(max_calls) };
            let budget = RunBudget::new(limits, SpentBudget::default());
            let mut open = Vec::new();
            for (most_usd, share, ends) in asked {
                if budget.reserve_money(Some(most_usd)).is_ok() {
                    open.push((most_usd, share));
                }
                if let Some((most_usd, share)) = open.pop().filter(|_| ends) {
                    budget.settle_reservation(Some(most_usd), most_usd * share);
                }
                let spent = *budget.spent.lock().unwrap();
                prop_assert!(spent.usd + spent.reserved_usd <= max_usd + 1e-6);
                prop_assert!(spent.calls <= max_calls);
            }
        }
    }

    #[test]
    fn without_a_price_money_cannot_be_bounded() {
        let bounded = RunBudget::new(RunLimits { max_usd: Some(1.0), max_calls: None }, SpentBudget::default());
        assert!(matches!(bounded.reserve_money(None), Err(RequestRefusedError::NoPrice)));
        assert!(RunBudget::new(RunLimits::default(), SpentBudget::default()).reserve_money(None).is_ok());
    }
}

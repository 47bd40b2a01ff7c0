//! What a run may spend, and what it has spent.

use crate::LedgerError;
use std::sync::{Mutex, PoisonError};

/// Bounds of a run as a whole, earlier processes of it counted.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Limits {
    /// Most US dollars.
    pub max_usd: Option<f64>,
    /// Most requests that are sent.
    pub max_calls: Option<u64>,
}

/// A request that may not leave.
#[derive(Debug, Clone, thiserror::Error)]
pub enum Refused {
    /// The user has interrupted.
    #[error("interrupted")]
    Stopped,
    /// It could cost more than is left.
    #[error(
        "--max-usd {max_usd} would not hold: ${spent_usd:.4} are spent or on the way, and the next request may cost ${next_usd:.4}"
    )]
    MaxUsd {
        /// The bound.
        max_usd: f64,
        /// Spent, reserved for what is in flight, and reserved for what was lost.
        spent_usd: f64,
        /// The request's upper bound.
        next_usd: f64,
    },
    /// The price of a request is not known, and money is bounded.
    #[error("--max-usd cannot be kept: the price of this model is not known")]
    NoPrice,
    /// As many requests as the run may send were sent.
    #[error("--max-calls {max_calls} is reached")]
    MaxCalls {
        /// The bound.
        max_calls: u64,
    },
    /// The ledger cannot keep what would be sent.
    #[error(transparent)]
    Ledger(#[from] LedgerError),
}

impl Refused {
    /// What stands in the way, and how to go on.
    #[must_use]
    pub fn told(&self) -> (String, String) {
        let hint = match self {
            Self::MaxUsd { .. } => "what was answered is kept: go on with the same command and a larger --max-usd",
            Self::MaxCalls { .. } => "what was answered is kept: go on with the same command and a larger --max-calls",
            Self::NoPrice => "add a row for it to a file, and give it as --prices FILE",
            Self::Stopped => "what was answered is kept: go on with the same command",
            Self::Ledger(_) => "see to the ledger's file, then go on with the same command",
        };
        // An error of the ledger brings its own hint.
        let text = self.to_string();
        let (reason, hint) = text.split_once("\nhint: ").unwrap_or((&text, hint));
        (reason.to_owned(), hint.to_owned())
    }
}

/// The purse of a run.
#[derive(Debug)]
pub(crate) struct Budget {
    limits: Limits,
    spent: Mutex<Spent>,
}

#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Spent {
    /// Paid, or maybe paid and lost.
    pub(crate) usd: f64,
    /// Upper bounds of what is in flight.
    pub(crate) reserved_usd: f64,
    /// Requests that were sent.
    pub(crate) calls: u64,
}

/// An amount of money. What cannot be added up and compared, such as what a broken table of prices yields, is not known.
pub(crate) fn known(usd: Option<f64>) -> Option<f64> {
    usd.filter(|usd| usd.is_finite() && *usd >= 0.0)
}

/// Rounding of sums of many small amounts must not refuse the last request that fits.
const ROUNDING_USD: f64 = 1e-9;

impl Budget {
    pub(crate) fn new(limits: Limits, spent: Spent) -> Self {
        Self { limits, spent: Mutex::new(spent) }
    }

    /// Sets money aside for a request.
    pub(crate) fn reserve(&self, most_usd: Option<f64>) -> Result<(), Refused> {
        let mut spent = self.spent.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(max_calls) = self.limits.max_calls.filter(|max_calls| spent.calls >= *max_calls) {
            return Err(Refused::MaxCalls { max_calls });
        }
        let next_usd = most_usd.unwrap_or(0.0);
        if let Some(max_usd) = self.limits.max_usd {
            if most_usd.is_none() {
                return Err(Refused::NoPrice);
            }
            let spent_usd = spent.usd + spent.reserved_usd;
            let fits = spent_usd + next_usd <= max_usd + ROUNDING_USD;
            if !fits {
                return Err(Refused::MaxUsd { max_usd, spent_usd, next_usd });
            }
        }
        spent.reserved_usd += next_usd;
        spent.calls += 1;
        Ok(())
    }

    /// Ends a reservation with what the request came to.
    pub(crate) fn settle(&self, most_usd: Option<f64>, usd: f64) {
        let mut spent = self.spent.lock().unwrap_or_else(PoisonError::into_inner);
        spent.reserved_usd -= most_usd.unwrap_or(0.0);
        spent.usd += usd;
    }

    /// Takes a reservation back for a request that never left.
    pub(crate) fn cancel(&self, most_usd: Option<f64>) {
        self.settle(most_usd, 0.0);
        self.spent.lock().unwrap_or_else(PoisonError::into_inner).calls -= 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Whatever is asked for and however it ends, the bounds hold at every moment.
        #[test]
        fn the_bounds_hold(
            max_usd in 0.0..1.0f64,
            max_calls in 0u64..30,
            asked in prop::collection::vec((0.0..0.2f64, 0.0..1.0f64, any::<bool>()), 0..60),
        ) {
            let limits = Limits { max_usd: Some(max_usd), max_calls: Some(max_calls) };
            let budget = Budget::new(limits, Spent::default());
            let mut open = Vec::new();
            for (most_usd, share, ends) in asked {
                if budget.reserve(Some(most_usd)).is_ok() {
                    open.push((most_usd, share));
                }
                if let Some((most_usd, share)) = open.pop().filter(|_| ends) {
                    budget.settle(Some(most_usd), most_usd * share);
                }
                let spent = *budget.spent.lock().unwrap();
                prop_assert!(spent.usd + spent.reserved_usd <= max_usd + 1e-6);
                prop_assert!(spent.calls <= max_calls);
            }
        }
    }

    #[test]
    fn without_a_price_money_cannot_be_bounded() {
        let bounded = Budget::new(Limits { max_usd: Some(1.0), max_calls: None }, Spent::default());
        assert!(matches!(bounded.reserve(None), Err(Refused::NoPrice)));
        assert!(Budget::new(Limits::default(), Spent::default()).reserve(None).is_ok());
    }
}

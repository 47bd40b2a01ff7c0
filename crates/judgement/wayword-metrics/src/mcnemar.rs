//! McNemar's test of two ways on the same items.

use serde::{Deserialize, Serialize};

/// How two ways differ on the items where one succeeds and the other does not.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct McNemar {
    /// Items on which the first alone succeeds.
    pub only_first: usize,
    /// Items on which the second alone succeeds.
    pub only_second: usize,
    /// Two-sided p of the exact binomial test. It takes items for independent.
    pub p: f64,
}

impl McNemar {
    /// Of the successes of both ways on each item.
    #[must_use]
    pub fn of(pairs: impl Iterator<Item = (bool, bool)>) -> Self {
        let (mut only_first, mut only_second) = (0, 0);
        for (first, second) in pairs {
            only_first += usize::from(first && !second);
            only_second += usize::from(second && !first);
        }
        Self { only_first, only_second, p: two_sided(only_first, only_second) }
    }
}

/// The two-sided p of a fair coin that fell so often on each side.
fn two_sided(heads: usize, tails: usize) -> f64 {
    let (tosses, fewer) = (heads + tails, heads.min(tails));
    // In logarithms: the probability of thousands of tosses is no number otherwise.
    let mut ln_share = -(tosses as f64) * std::f64::consts::LN_2;
    let mut tail = 0.0;
    for count in 0..=fewer {
        tail += ln_share.exp();
        ln_share += ((tosses - count) as f64).ln() - ((count + 1) as f64).ln();
    }
    (2.0 * tail).min(1.0)
}

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

//! What a model costs.

/// A model's price, US dollars per million tokens.
#[derive(Debug, Clone, PartialEq)]
pub struct Price {
    /// For what it is sent.
    pub usd_per_million_in: f64,
    /// For what it says.
    pub usd_per_million_out: f64,
    /// The day of the price list.
    pub as_of: String,
}

impl Price {
    /// Of what runs in process.
    #[cfg(feature = "remote")]
    pub(super) fn nothing() -> Self {
        Self { usd_per_million_in: 0.0, usd_per_million_out: 0.0, as_of: String::new() }
    }

    /// What so many tokens cost, US dollars.
    #[must_use]
    pub fn usd(&self, tokens_in: u64, tokens_out: u64) -> f64 {
        (tokens_in as f64 * self.usd_per_million_in + tokens_out as f64 * self.usd_per_million_out) / 1e6
    }
}

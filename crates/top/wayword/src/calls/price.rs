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
    /// What so many tokens cost, US dollars.
    #[must_use]
    pub fn usd(&self, tokens_in: u64, tokens_out: u64) -> f64 {
        (tokens_in as f64 * self.usd_per_million_in + tokens_out as f64 * self.usd_per_million_out) / 1e6
    }
}

//! Prices of models: the built-in table (`prices.toml`), with the user's rows over it.

use crate::PricesError;
use serde::Deserialize;
use std::collections::BTreeMap;

/// The built-in table, as TOML.
const BUILT_IN: &str = include_str!("prices.toml");

/// The price of a model.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelPrice {
    /// US dollars per million tokens of the request.
    pub usd_per_million_in: f64,
    /// US dollars per million tokens of the reply.
    pub usd_per_million_out: f64,
    /// The day on which the price was last checked; empty only for [`ModelPrice::free_of_charge`].
    pub as_of: String,
    /// The most tokens that a picture counts as.
    #[serde(default = "tokens_per_picture")]
    pub tokens_per_picture: u64,
}

/// The most tokens that a picture counts as, where a row of the table has no number of its own.
fn tokens_per_picture() -> u64 {
    1600
}

/// Prices by `provider/model`.
#[derive(Debug, Clone, PartialEq)]
pub struct PriceTable(BTreeMap<String, ModelPrice>);

impl ModelPrice {
    /// The price of a model on a user's own machine.
    #[must_use]
    pub fn free_of_charge() -> Self {
        Self { usd_per_million_in: 0.0, usd_per_million_out: 0.0, as_of: String::new(), tokens_per_picture: 0 }
    }

    /// The cost of a call with these tokens, US dollars.
    #[must_use]
    pub fn cost_usd(&self, tokens_in: u64, tokens_out: u64) -> f64 {
        (tokens_in as f64 * self.usd_per_million_in + tokens_out as f64 * self.usd_per_million_out) / 1e6
    }
}

impl Default for PriceTable {
    fn default() -> Self {
        Self::built_in()
    }
}

impl PriceTable {
    /// The table that comes with the program.
    #[must_use]
    pub fn built_in() -> Self {
        // The file is part of the program and a test reads it, so it cannot be wrong here.
        Self(toml::from_str(BUILT_IN).unwrap_or_default())
    }

    /// The built-in table, with the user's rows (the text of a TOML file) in place of rows of the same name.
    ///
    /// # Errors
    /// When the text is not a table of prices, or an amount is negative.
    pub fn from_toml(text: &str) -> Result<Self, PricesError> {
        let user_rows: BTreeMap<String, ModelPrice> =
            toml::from_str(text).map_err(|error| PricesError::Toml(error.to_string()))?;
        let is_amount = |usd: f64| usd.is_finite() && usd >= 0.0;
        let wrong = user_rows
            .iter()
            .find(|(_, price)| !is_amount(price.usd_per_million_in) || !is_amount(price.usd_per_million_out));
        if let Some((name, _)) = wrong {
            return Err(PricesError::Amount(name.clone()));
        }
        let mut prices = Self::built_in();
        prices.0.extend(user_rows);
        Ok(prices)
    }

    /// The price of a model: by its name, or by the longest listed name that it is a dated snapshot of.
    pub(crate) fn for_model(&self, name: &str) -> Option<ModelPrice> {
        // In reverse order a longer name comes before its beginnings.
        let snapshot = || self.0.iter().rev().find(|(base, _)| is_snapshot(name, base)).map(|(_, price)| price);
        self.0.get(name).or_else(snapshot).cloned()
    }
}

/// Whether a name is another one followed by a date: `-2025-04-14`, `-20250414`, `-0414` or `-2504`.
fn is_snapshot(name: &str, base: &str) -> bool {
    let Some(date) = name.strip_prefix(base).and_then(|rest| rest.strip_prefix('-')) else { return false };
    let digits = date.bytes().filter(u8::is_ascii_digit).count();
    let shape = date.bytes().all(|byte| byte.is_ascii_digit() || byte == b'-')
        && !date.starts_with('-')
        && !date.ends_with('-');
    shape && matches!(digits, 4 | 6 | 8) && (digits == date.len() || (digits == 8 && date.len() == 10))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::provider;

    #[test]
    fn the_built_in_table_is_read_and_dated() {
        let table: BTreeMap<String, ModelPrice> = toml::from_str(BUILT_IN).unwrap();
        assert!(table.len() > 30);
        let providers = provider::built_in();
        for (name, price) in &table {
            assert!(price.as_of.parse::<toml::value::Datetime>().is_ok(), "{name}");
            assert!(price.usd_per_million_in > 0.0 && price.usd_per_million_out > 0.0, "{name}");
            assert!(providers.contains_key(provider::split_name(name).unwrap().0), "{name}");
        }
    }

    #[test]
    fn a_snapshot_has_the_price_of_its_model() {
        let prices = PriceTable::built_in();
        assert_eq!(prices.for_model("openai/gpt-4.1-mini-2025-04-14"), prices.for_model("openai/gpt-4.1-mini"));
        assert_eq!(prices.for_model("anthropic/claude-sonnet-4-20250514").unwrap().usd_per_million_in, 3.0);
        assert_eq!(prices.for_model("openai/gpt-4o-2024-05-13").unwrap().usd_per_million_in, 5.0);
        assert_eq!(prices.for_model("openai/gpt-4.1-huge"), None);
        assert_eq!(prices.for_model("openai/gpt-4.1-"), None);
        assert_eq!(prices.for_model("openai/gpt-4.1-2025"), prices.for_model("openai/gpt-4.1"));
    }

    #[test]
    fn read_puts_a_users_rows_over_the_built_in_ones() {
        let row = "\"x/y\" = { usd_per_million_in = 1, usd_per_million_out = 2.5, as_of = \"2026-01-01\" }";
        let prices = PriceTable::from_toml(row).unwrap();
        assert_eq!(prices.for_model("x/y").unwrap().cost_usd(2_000_000, 1_000_000), 4.5);
        assert!(prices.for_model("openai/gpt-4o").is_some());
        assert!(matches!(PriceTable::from_toml(&row.replace("2.5", "-2.5")), Err(PricesError::Amount(_))));
        assert!(matches!(PriceTable::from_toml("x = 1"), Err(PricesError::Toml(_))));
    }
}

//! Adds up the calls, tokens and money that a command would need from each model.

use super::JobModels;
use crate::count::count_phrase;
use serde::Serialize;
use std::fmt;

/// The expected load of each model, one entry per model.
#[derive(Debug, Default, Serialize)]
#[serde(transparent)]
pub struct ModelBill(Vec<ModelBillEntry>);

/// The expected load of one model in all its roles.
#[derive(Debug, Default, Serialize)]
struct ModelBillEntry {
    model: String,
    roles: Vec<&'static str>,
    calls: u64,
    tokens_in: u64,
    tokens_out: u64,
    /// US dollars; absent if the model's price is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    usd: Option<f64>,
    /// The day of the price list.
    #[serde(skip_serializing_if = "Option::is_none")]
    price_as_of: Option<String>,
}

/// Calls and tokens of one role.
#[derive(Debug, Clone, Copy, Default)]
pub struct CallLoad {
    /// Number of calls.
    pub calls: u64,
    /// Tokens that are sent.
    pub tokens_in: u64,
    /// Tokens that come back.
    pub tokens_out: u64,
}

/// Pixels of a picture for each of its tokens, as two large providers count.
const PIXELS_PER_TOKEN: u64 = 750;

/// Tokens of a picture with sides of 4 to 3. `picture_px` is its longer side, pixels.
pub fn picture_tokens(picture_px: u32) -> u64 {
    u64::from(picture_px).pow(2) * 3 / 4 / PIXELS_PER_TOKEN
}

impl ModelBill {
    /// Adds the load of a model in one role.
    pub fn add_load(&mut self, model: &str, role: &'static str, load: CallLoad) {
        let at = self.0.iter().position(|entry| entry.model == model).unwrap_or_else(|| {
            self.0.push(ModelBillEntry { model: model.to_owned(), ..ModelBillEntry::default() });
            self.0.len() - 1
        });
        if let Some(entry) = self.0.get_mut(at) {
            entry.roles.push(role);
            entry.calls += load.calls;
            entry.tokens_in += load.tokens_in;
            entry.tokens_out += load.tokens_out;
        }
    }

    /// Fills in what each model costs, where that is known.
    pub fn fill_prices(&mut self, models: &JobModels<'_>) {
        for entry in &mut self.0 {
            let price = models.model_price(&entry.model);
            entry.usd = price.map(|price| price.cost_usd(entry.tokens_in, entry.tokens_out));
            entry.price_as_of = price.map(|price| price.as_of.clone());
        }
    }

    /// Calls of all models.
    pub(crate) fn call_count(&self) -> u64 {
        self.0.iter().map(|entry| entry.calls).sum()
    }

    /// US dollars of all models; `None` if a price is not known.
    pub(crate) fn total_usd(&self) -> Option<f64> {
        self.0.iter().map(|entry| entry.usd).sum()
    }

    /// Whether no model would be asked.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl CallLoad {
    /// Adds a call.
    pub fn add_call(&mut self, prompt: &str, tokens_out: u64) {
        // English text has about four bytes per token.
        self.add(Self { calls: 1, tokens_in: prompt.len().div_ceil(4) as u64, tokens_out });
    }

    /// Adds another load.
    pub(crate) fn add(&mut self, other: Self) {
        *self = self.plus(other);
    }

    /// The sum of both.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            calls: self.calls + other.calls,
            tokens_in: self.tokens_in + other.tokens_in,
            tokens_out: self.tokens_out + other.tokens_out,
        }
    }

    /// So many hundredths of this load, rounded.
    pub(crate) fn share(self, hundredths: u64) -> Self {
        let of = |count: u64| (count * hundredths + 50) / 100;
        Self { calls: of(self.calls), tokens_in: of(self.tokens_in), tokens_out: of(self.tokens_out) }
    }

    /// This load, multiplied by a number.
    pub fn times(self, times: u64) -> Self {
        Self { calls: self.calls * times, tokens_in: self.tokens_in * times, tokens_out: self.tokens_out * times }
    }
}

/// A line for each model, and one for all.
impl fmt::Display for ModelBill {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for entry in &self.0 {
            write!(
                f,
                "  {} ({}): {}, about {} in, {} out",
                entry.model,
                entry.roles.join(", "),
                count_phrase(entry.calls, "call"),
                count_phrase(entry.tokens_in, "token"),
                entry.tokens_out
            )?;
            match (entry.usd, &entry.price_as_of) {
                (Some(0.0), _) => writeln!(f, ", free: it runs in process")?,
                (Some(usd), Some(day)) => writeln!(f, ", about ${usd:.2} (prices of {day})")?,
                _ => writeln!(f, ", price not known (see --prices)")?,
            }
        }
        match self.total_usd() {
            Some(usd) => write!(f, "in all: about ${usd:.2}"),
            None => write!(f, "in all: not known, because a price is missing"),
        }
    }
}

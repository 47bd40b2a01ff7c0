//! Limits of one walk of the agent with a language model: hops, calls, cost, and how much it remembers.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Limits of one walk.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ToolWalkLimits {
    /// Most hops, those back included.
    pub max_hops: usize,
    /// Most calls of the model.
    pub max_calls: usize,
    /// Most US dollars for the model's replies. The walk ends after the reply that exceeds it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_usd: Option<f64>,
    /// How many of the agent's last steps each prompt repeats, with their reasons.
    pub memory: usize,
}

/// People's walks in R2R have 4 to 6 hops; the agent that reads goes 24 at most.
impl Default for ToolWalkLimits {
    fn default() -> Self {
        Self { max_hops: 24, max_calls: 60, max_usd: None, memory: 6 }
    }
}

impl ToolWalkLimits {
    /// All of them by name, for reports.
    #[must_use]
    pub fn by_name(&self) -> BTreeMap<String, String> {
        let usd = self.max_usd.map(|usd| ("max_usd", usd.to_string()));
        let counts = [
            ("max_hops", self.max_hops.to_string()),
            ("max_calls", self.max_calls.to_string()),
            ("memory", self.memory.to_string()),
        ];
        counts.into_iter().chain(usd).map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

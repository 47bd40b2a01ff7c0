//! The user's settings for services, as they are read from TOML.

use crate::PriceTable;
use serde::Deserialize;
use std::collections::BTreeMap;

/// How services are used.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RemoteConfig {
    /// Providers by name. Their fields override those of the built-in table, and new names add to it.
    pub providers: BTreeMap<String, ProviderConfig>,
    /// Base URL of the one provider in use.
    pub base_url: Option<String>,
    /// Name of the environment variable with the key of the one provider in use.
    pub key_env: Option<String>,
    /// The longer side that pictures are scaled down to, pixels.
    pub picture_px: u32,
    /// Most time for one attempt, from looking up the host to the last byte, seconds.
    pub timeout_s: f64,
    /// Most requests in flight at once, per provider.
    pub concurrency: RequestConcurrency,
    /// Most requests for one call: the first one, and repeats after faults.
    pub attempts: u32,
    /// Most requests per minute, for providers that set no limit themselves.
    pub requests_per_minute: Option<f64>,
    /// Most tokens per minute, in and out, for providers that set no limit themselves.
    pub tokens_per_minute: Option<f64>,
    /// The prices of models.
    #[serde(skip)]
    pub prices: PriceTable,
    /// Refuse models without a price, because there is a limit on money.
    #[serde(skip)]
    pub needs_prices: bool,
}

/// How many requests are in flight at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(untagged)]
pub enum RequestConcurrency {
    /// Always up to this many.
    Fixed(usize),
    /// As many as the service can take: starts at 8.
    Adaptive {
        /// The most requests in flight at once.
        most: usize,
    },
}

/// A provider's settings. An absent field has the value of the built-in table.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ProviderConfig {
    /// The API of the provider.
    pub dialect: Option<ServiceDialect>,
    /// The address of the provider, up to the version (`https://api.openai.com/v1`).
    pub base_url: Option<String>,
    /// Name of the environment variable with its key.
    pub key_env: Option<String>,
    /// Whether the provider runs on this machine, free of charge.
    pub local: Option<bool>,
    /// Whether none of its models takes pictures.
    pub blind: Option<bool>,
    /// The most tokens that its models read and write at once. Prompts to write are shortened to fit.
    pub context_tokens: Option<u64>,
    /// Its field for the most tokens of a reply (OpenAI's dialects only).
    pub max_tokens_field: Option<String>,
    /// Its field for the seed (OpenAI's dialects only).
    pub seed_field: Option<String>,
    /// Fields that are merged into every request's body (`reasoning_effort`, `think`, ...).
    pub extra: Option<serde_json::Map<String, serde_json::Value>>,
    /// Those of `temperature`, `seed` and `max_tokens` that are not sent.
    pub omit: Option<Vec<String>>,
    /// How a request asks the provider for a reply in JSON.
    pub json: Option<JsonMode>,
    /// Whether its models can call tools.
    pub tools: Option<bool>,
    /// Most requests per minute.
    pub requests_per_minute: Option<f64>,
    /// Most tokens per minute, in and out.
    pub tokens_per_minute: Option<f64>,
    /// Whether the `x-ratelimit` headers of its responses give the number of requests per day, and not per minute.
    pub advertises_requests_per_day: Option<bool>,
}

/// A service's API.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ServiceDialect {
    /// OpenAI's chat completions, which most other servers offer too.
    #[serde(rename = "openai")]
    OpenAi,
    /// OpenAI's legacy completions: one prompt, no pictures.
    Completions,
    /// Anthropic's messages.
    Anthropic,
    /// Gemini's `generateContent`.
    Gemini,
    /// Ollama's own `/api/chat`.
    Ollama,
}

/// How a request asks a service for a reply in JSON.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JsonMode {
    /// The request contains the schema, and the service makes the model follow it.
    Schema,
    /// The service makes the model write JSON; the prompt describes the form.
    Object,
    /// Only the prompt asks for it.
    #[default]
    Prompt,
}

impl ServiceDialect {
    /// The name of the dialect in settings, errors and the ledger.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::OpenAi => "openai",
            Self::Completions => "completions",
            Self::Anthropic => "anthropic",
            Self::Gemini => "gemini",
            Self::Ollama => "ollama",
        }
    }

    /// The path that is added to a base URL without one.
    pub(crate) fn default_version_path(self) -> &'static str {
        match self {
            Self::Anthropic => "/v1",
            Self::Gemini => "/v1beta",
            Self::OpenAi | Self::Completions | Self::Ollama => "",
        }
    }

    /// What base URLs of this dialect mostly end in; empty where they have no path.
    pub(crate) fn usual_version_path(self) -> &'static str {
        match self {
            Self::OpenAi | Self::Completions => "/v1",
            other => other.default_version_path(),
        }
    }

    /// Whether a message of this dialect can hold pictures.
    pub(crate) fn takes_pictures(self) -> bool {
        self != Self::Completions
    }
}

impl Default for RemoteConfig {
    fn default() -> Self {
        Self {
            providers: BTreeMap::new(),
            base_url: None,
            key_env: None,
            picture_px: 512,
            timeout_s: 120.0,
            concurrency: RequestConcurrency::Adaptive { most: 64 },
            attempts: 6,
            requests_per_minute: None,
            tokens_per_minute: None,
            prices: PriceTable::default(),
            needs_prices: false,
        }
    }
}

impl RequestConcurrency {
    /// Most requests in flight at once.
    #[must_use]
    pub fn max_in_flight(self) -> usize {
        match self {
            Self::Fixed(most) | Self::Adaptive { most } => most.max(1),
        }
    }

    /// How many threads keep that many requests in flight, while some threads wait for the ledger or for their next
    /// attempt.
    #[must_use]
    pub fn thread_count(self) -> usize {
        self.max_in_flight() + self.max_in_flight() / 2 + 1
    }
}

impl ProviderConfig {
    /// These settings, with each field that `other` sets replaced by that of `other`.
    pub(crate) fn overridden_by(mut self, other: &Self) -> Self {
        macro_rules! take {
            ($($field:ident),*) => { $(if other.$field.is_some() { self.$field.clone_from(&other.$field); })* };
        }
        take!(dialect, base_url, key_env, local, blind, context_tokens, max_tokens_field, seed_field, extra, omit);
        take!(requests_per_minute, tokens_per_minute, advertises_requests_per_day, json, tools);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_user_writes_toml() {
        let config: RemoteConfig = toml::from_str(
            r#"
            concurrency = { most = 16 }
            timeout_s = 30
            [providers.openai]
            omit = ["temperature"]
            extra = { reasoning_effort = "minimal" }
            [providers.mine]
            dialect = "openai"
            base_url = "http://10.0.0.2:8000/v1"
            "#,
        )
        .unwrap();
        assert_eq!(config.concurrency, RequestConcurrency::Adaptive { most: 16 });
        assert_eq!(config.attempts, 6);
        assert_eq!(config.providers["mine"].dialect, Some(ServiceDialect::OpenAi));
        assert!(
            toml::from_str::<RemoteConfig>("concurrency = 32").unwrap().concurrency == RequestConcurrency::Fixed(32)
        );
        assert!(toml::from_str::<RemoteConfig>("cocurrency = 32").is_err());
    }
}

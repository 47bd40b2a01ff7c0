//! The services of a run. Finds a model by its name, and opens each provider once, so that its models share connections
//! and limits.

use crate::{
    ConfigError, ModelPrice, RemoteConfig, RemoteModel, RequestConcurrency,
    endpoint::ProviderEndpoint,
    picture::PictureEncoder,
    provider::{self, ProviderTable, RemoteProvider},
    transport,
};
use std::{
    collections::BTreeMap,
    fmt,
    sync::{Arc, Mutex, PoisonError},
};
use ureq::tls::RootCerts;
use wayword_ledger::LedgerRun;

/// Longest timeout of an attempt that a user may set, seconds.
const MAX_TIMEOUT_S: f64 = 3600.0;

/// The most requests at once that a user may set.
const MAX_CONCURRENCY: usize = 4096;

/// The longest side of a picture that a user may set, pixels.
const MAX_PICTURE_PX: u32 = 8192;

/// Finds models by their names. Models of one provider share its connections and limits.
pub struct ModelServices {
    config: RemoteConfig,
    table: ProviderTable,
    run: LedgerRun,
    pictures: Arc<PictureEncoder>,
    endpoints: Mutex<BTreeMap<String, Arc<ProviderEndpoint>>>,
}

impl ModelServices {
    /// Services for one run of the ledger. Makes no connection, and reads no key.
    ///
    /// # Errors
    /// When a setting is out of range.
    pub fn new(config: RemoteConfig, run: LedgerRun) -> Result<Self, ConfigError> {
        let wrong = |setting: &str, problem| Err(ConfigError::Setting { setting: setting.to_owned(), problem });
        let max_in_flight = match config.concurrency {
            RequestConcurrency::Fixed(most) | RequestConcurrency::Adaptive { most } => most,
        };
        if !(1..=MAX_CONCURRENCY).contains(&max_in_flight) {
            return wrong("concurrency", "must be from 1 to 4096");
        }
        if !(1..=MAX_PICTURE_PX).contains(&config.picture_px) {
            return wrong("picture_px", "must be from 1 to 8192");
        }
        // NaN is not above 0 either.
        if !(config.timeout_s > 0.0 && config.timeout_s <= MAX_TIMEOUT_S) {
            return wrong("timeout_s", "must be above 0 and at most 3600");
        }
        if config.attempts == 0 {
            return wrong("attempts", "must be at least 1");
        }
        let table = ProviderTable::new(&config.providers);
        let pictures = Arc::new(PictureEncoder::new(config.picture_px));
        Ok(Self { config, table, run, pictures, endpoints: Mutex::default() })
    }

    /// A model by its name, `provider/model`.
    ///
    /// # Errors
    /// When the provider does not exist, its settings are wrong, or a price is needed and not known.
    pub fn model(&self, name: &str) -> Result<Arc<RemoteModel>, ConfigError> {
        let (provider, _) = provider::split_name(name)?;
        let endpoint = self.endpoint_for(provider)?;
        let price = self.find_price(name, &endpoint.provider);
        if self.config.needs_prices {
            if price.is_none() {
                return Err(ConfigError::NoPrice(name.to_owned()));
            }
            if changes_token_limit(&endpoint.provider) {
                return Err(ConfigError::Setting {
                    setting: format!("omit or extra of [providers.{provider}]"),
                    problem: "must not change the token limit if there is a limit on money, because that one depends on it",
                });
            }
        }
        Ok(Arc::new(RemoteModel {
            name: name.to_owned(),
            endpoint,
            run: self.run.clone(),
            pictures: Arc::clone(&self.pictures),
            price,
            attempts: self.config.attempts,
            threads: self.config.concurrency.thread_count(),
        }))
    }

    /// The price of a model. A local provider is free on this machine. At another address it counts as free only if the
    /// user sets no limit on money, because the same software may be a paid service there.
    fn find_price(&self, name: &str, provider: &RemoteProvider) -> Option<ModelPrice> {
        let is_free = provider.local && (provider.base_url.loopback || !self.config.needs_prices);
        self.config.prices.for_model(name).or_else(|| is_free.then(ModelPrice::free_of_charge))
    }

    /// The names of all providers.
    #[must_use]
    pub fn provider_names(&self) -> Vec<&str> {
        self.table.provider_names()
    }

    /// What the user should know of the services that were asked: at most one note for each.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let endpoints = self.endpoints.lock().unwrap_or_else(PoisonError::into_inner);
        endpoints.values().filter_map(|endpoint| endpoint.noted().map(str::to_owned)).collect()
    }

    /// Whether the user has given a provider's address.
    pub(crate) fn has_own_address(&self, provider: &str) -> bool {
        let own_url = self.config.providers.get(provider).and_then(|settings| settings.base_url.as_ref());
        self.config.base_url.is_some() || own_url.is_some()
    }

    /// The endpoint of a provider, which is opened at the first call.
    fn endpoint_for(&self, provider: &str) -> Result<Arc<ProviderEndpoint>, ConfigError> {
        let mut endpoints = self.endpoints.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(endpoint) = endpoints.get(provider) {
            return Ok(Arc::clone(endpoint));
        }
        let resolved = self.table.resolve_provider(provider, &self.config)?;
        let is_for_one_provider = self.config.base_url.is_some() || self.config.key_env.is_some();
        if let (true, Some(first)) = (is_for_one_provider, endpoints.keys().next()) {
            return Err(ConfigError::Several { first: first.clone(), second: provider.to_owned() });
        }
        let roots = match resolved.base_url.plain {
            true => RootCerts::WebPki,
            false => transport::trusted_roots().map_err(|problem| ConfigError::Setting {
                setting: format!("the variable {}", transport::CERTIFICATES_VARIABLE),
                problem,
            })?,
        };
        let endpoint = Arc::new(ProviderEndpoint::new(resolved, &self.config, roots, self.run.shares_rates()));
        endpoints.insert(provider.to_owned(), Arc::clone(&endpoint));
        Ok(endpoint)
    }
}

impl fmt::Debug for ModelServices {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Leaves out the settings, because a user may have typed a key in the wrong place.
        f.debug_struct("Services").field("providers", &self.provider_names()).finish_non_exhaustive()
    }
}

/// Whether settings remove the token limit from a request, replace it, or ask for several answers at once.
fn changes_token_limit(provider: &RemoteProvider) -> bool {
    // Fields of a request's body that do so in one of the dialects.
    const IN_BODY: [&str; 8] = [
        "max_tokens",
        "max_completion_tokens",
        "max_output_tokens",
        "n",
        "best_of",
        "num_predict",
        "options",
        "generationConfig",
    ];
    let omits = provider.omit.iter().any(|field| field == "max_tokens");
    omits || IN_BODY.iter().any(|field| provider.extra.contains_key(*field))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ProviderConfig;
    use wayword_ledger::{Ledger, RunLimits};

    /// Why a model is refused if there is a limit on money.
    fn refused(base_url: Option<&str>, provider: &str, config: ProviderConfig) -> Option<String> {
        let config = RemoteConfig {
            providers: [(provider.to_owned(), config)].into(),
            base_url: base_url.map(str::to_owned),
            needs_prices: true,
            ..RemoteConfig::default()
        };
        let run = Ledger::in_memory().unwrap().start_run("test", RunLimits::default()).unwrap();
        let services = ModelServices::new(config, run).unwrap();
        services.model(&format!("{provider}/gpt-4.1-mini")).err().map(|error| error.to_string())
    }

    #[test]
    fn local_models_are_free_only_on_this_machine() {
        assert_eq!(refused(None, "vllm", ProviderConfig::default()), None);
        let told = refused(Some("https://models.example.com/v1"), "vllm", ProviderConfig::default()).unwrap();
        assert!(told.contains("price"), "{told}");
    }

    #[test]
    fn money_is_not_bounded_where_the_limit_of_tokens_is_not() {
        assert_eq!(refused(None, "openai", ProviderConfig::default()), None);
        let omits = ProviderConfig { omit: Some(vec!["max_tokens".to_owned()]), ..ProviderConfig::default() };
        let extra = [("n".to_owned(), 3.into())].into_iter().collect();
        let several = ProviderConfig { extra: Some(extra), ..ProviderConfig::default() };
        for config in [omits, several] {
            let told = refused(None, "openai", config).unwrap();
            assert!(told.contains("[providers.openai]"), "{told}");
        }
    }
}

//! The services of a run: every provider that is in use, once.

use crate::{
    Concurrency, Config, ConfigError, Price, RemoteModel,
    endpoint::Endpoint,
    picture::Pictures,
    provider::{self, Table},
};
use std::{
    collections::BTreeMap,
    fmt,
    sync::{Arc, Mutex, PoisonError},
};
use wayword_ledger::Run;

/// Longest that an attempt may be given, seconds.
const LONGEST_TIMEOUT_S: f64 = 3600.0;

/// Most requests at once that anybody can want.
const MOST_CONCURRENCY: usize = 4096;

/// Longest side of a picture that a service takes, pixels.
const LARGEST_PICTURE_PX: u32 = 8192;

/// Gives models by their names. Models of one provider share its connections and limits.
pub struct Services {
    config: Config,
    table: Table,
    run: Run,
    pictures: Arc<Pictures>,
    endpoints: Mutex<BTreeMap<String, Arc<Endpoint>>>,
}

impl Services {
    /// Services for one run of the ledger. No connection is made, and no key read.
    ///
    /// # Errors
    /// When a setting makes no sense.
    pub fn new(config: Config, run: Run) -> Result<Self, ConfigError> {
        let wrong = |setting: &str, problem| Err(ConfigError::Setting { setting: setting.to_owned(), problem });
        let most = match config.concurrency {
            Concurrency::Fixed(most) | Concurrency::Adaptive { most } => most,
        };
        if !(1..=MOST_CONCURRENCY).contains(&most) {
            return wrong("concurrency", "must be from 1 to 4096");
        }
        if !(1..=LARGEST_PICTURE_PX).contains(&config.picture_px) {
            return wrong("picture_px", "must be from 1 to 8192");
        }
        // NaN is not above 0 either.
        if !(config.timeout_s > 0.0 && config.timeout_s <= LONGEST_TIMEOUT_S) {
            return wrong("timeout_s", "must be above 0 and at most 3600");
        }
        if config.attempts == 0 {
            return wrong("attempts", "must be at least 1");
        }
        let table = Table::new(&config.providers);
        let pictures = Arc::new(Pictures::new(config.picture_px));
        Ok(Self { config, table, run, pictures, endpoints: Mutex::default() })
    }

    /// A model by its name, `provider/model`.
    ///
    /// # Errors
    /// When there is no such provider, its description is wrong, or a price is needed and not known.
    pub fn model(&self, name: &str) -> Result<Arc<RemoteModel>, ConfigError> {
        let (provider, _) = provider::split(name)?;
        let endpoint = self.endpoint(provider)?;
        let price = if endpoint.provider.local { Some(Price::nothing()) } else { self.config.prices.of(name) };
        if self.config.needs_prices && price.is_none() {
            return Err(ConfigError::NoPrice(name.to_owned()));
        }
        Ok(Arc::new(RemoteModel {
            name: name.to_owned(),
            endpoint,
            run: self.run.clone(),
            pictures: Arc::clone(&self.pictures),
            price,
            attempts: self.config.attempts,
            threads: self.config.concurrency.threads(),
        }))
    }

    /// The providers that can be named.
    #[must_use]
    pub fn names(&self) -> Vec<&str> {
        self.table.names()
    }

    fn endpoint(&self, provider: &str) -> Result<Arc<Endpoint>, ConfigError> {
        let mut endpoints = self.endpoints.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(endpoint) = endpoints.get(provider) {
            return Ok(Arc::clone(endpoint));
        }
        let resolved = self.table.resolve(provider, &self.config)?;
        let for_one = self.config.base_url.is_some() || self.config.key_env.is_some();
        if let (true, Some(first)) = (for_one, endpoints.keys().next()) {
            return Err(ConfigError::Several { first: first.clone(), second: provider.to_owned() });
        }
        let endpoint = Arc::new(Endpoint::new(resolved, &self.config));
        endpoints.insert(provider.to_owned(), Arc::clone(&endpoint));
        Ok(endpoint)
    }
}

impl fmt::Debug for Services {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Settings are as a user typed them: a key may stand in the wrong place.
        f.debug_struct("Services").field("providers", &self.names()).finish_non_exhaustive()
    }
}

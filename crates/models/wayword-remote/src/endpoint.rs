//! One provider in use: its connections, its limits, its key and, once the service refuses all requests, the reason.

use crate::{
    RemoteConfig, ServiceSecret,
    dialect::WireRequest,
    faults::FaultContext,
    first_calls::FirstCalls,
    limiter::{EndpointLimiter, LimiterRules},
    provider::RemoteProvider,
    transport::{HttpResponse, HttpTransport},
};
use std::{
    sync::{
        OnceLock,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};
use ureq::tls::RootCerts;
use wayword_ledger::ProviderRates;

/// Why no more requests are sent, and how the user can change this.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ClosedEndpoint {
    pub(crate) reason: String,
    pub(crate) hint: String,
}

/// One provider in use. All its models share it.
pub(crate) struct ProviderEndpoint {
    pub(crate) provider: RemoteProvider,
    pub(crate) limiter: EndpointLimiter,
    transport: HttpTransport,
    /// Read when the provider is first used, because a run that is answered from the ledger needs no key.
    secret: OnceLock<Result<Option<ServiceSecret>, String>>,
    /// Set when the key is refused or the quota is used up, so that the other threads stop sending.
    closed: OnceLock<ClosedEndpoint>,
    /// What the user should know of the service, once.
    note: OnceLock<String>,
    /// Which calls go ahead alone, because none of their kind was answered yet.
    pub(crate) first_calls: FirstCalls,
    /// Whether a call was answered.
    has_answered: AtomicBool,
}

impl ProviderEndpoint {
    /// Opens a provider. Sends nothing, and trusts the certificates of `roots`. With `shares_rates` the ledger enforces the user's rates for all workers
    /// together. Rates that the service advertises are enforced here in both cases.
    pub(crate) fn new(provider: RemoteProvider, config: &RemoteConfig, roots: RootCerts, shares_rates: bool) -> Self {
        let local_rate = |rate: Option<f64>| rate.filter(|_| !shares_rates);
        let rules = LimiterRules {
            concurrency: config.concurrency,
            requests_per_minute: local_rate(provider.requests_per_minute),
            tokens_per_minute: local_rate(provider.tokens_per_minute),
        };
        let timeout = Duration::from_secs_f64(config.timeout_s);
        Self {
            transport: HttpTransport::new(&provider.base_url, config.concurrency.max_in_flight(), timeout, roots),
            limiter: EndpointLimiter::new(rules),
            secret: OnceLock::new(),
            closed: OnceLock::new(),
            note: OnceLock::new(),
            first_calls: FirstCalls::default(),
            has_answered: AtomicBool::new(false),
            provider,
        }
    }

    /// The user's rates, for a ledger that enforces them for all workers, and their name in that ledger.
    pub(crate) fn shared_rates(&self) -> (String, ProviderRates) {
        let per_s = |per_minute: Option<f64>| per_minute.map(|rate| rate / 60.0);
        let rates = ProviderRates {
            requests_per_s: per_s(self.provider.requests_per_minute),
            tokens_per_s: per_s(self.provider.tokens_per_minute),
        };
        (format!("{} {}", self.provider.name, self.provider.base_url.as_str()), rates)
    }

    /// The key, if the provider has one.
    ///
    /// # Errors
    /// When its variable is not set or contains no key.
    pub(crate) fn find_secret(&self) -> Result<Option<&ServiceSecret>, ClosedEndpoint> {
        let read = || self.provider.key_env.as_deref().map(ServiceSecret::from_env).transpose();
        match self.secret.get_or_init(read) {
            Ok(secret) => Ok(secret.as_ref()),
            Err(problem) => Err(ClosedEndpoint {
                reason: format!("{} needs a key, and {problem}", self.provider.name),
                hint: format!("export {}=...", self.provider.key_env.as_deref().unwrap_or_default()),
            }),
        }
    }

    /// The details of this provider that messages about faults need.
    pub(crate) fn fault_context(&self) -> FaultContext<'_> {
        FaultContext {
            provider: &self.provider.name,
            key_env: self.provider.key_env.as_deref(),
            secret: self.find_secret().ok().flatten(),
            version_path: self.provider.dialect.usual_version_path(),
            has_answered: self.has_answered.load(Ordering::Relaxed),
        }
    }

    /// Stops all further requests.
    pub(crate) fn close_with(&self, closed: ClosedEndpoint) {
        // The first reason is kept, because later ones follow from it.
        let _ = self.closed.set(closed);
    }

    /// Why no more requests are sent; `None` while requests are sent.
    pub(crate) fn closed_reason(&self) -> Option<&ClosedEndpoint> {
        self.closed.get()
    }

    /// Notes that the service answered as it should.
    pub(crate) fn note_answer(&self) {
        self.has_answered.store(true, Ordering::Relaxed);
    }

    /// Keeps what the user should know of the service; only the first of several.
    pub(crate) fn note(&self, note: String) {
        let _ = self.note.set(note);
    }

    /// What the user should know of the service.
    pub(crate) fn noted(&self) -> Option<&str> {
        self.note.get().map(String::as_str)
    }

    /// Sends a request.
    ///
    /// # Errors
    /// When no status came back.
    pub(crate) fn post_request(&self, wire: &WireRequest, body: &[u8]) -> Result<HttpResponse, ureq::Error> {
        self.transport.post(&self.provider.base_url.with_path(&wire.path), &self.request_headers(), body)
    }

    /// Asks for the service's list of models.
    ///
    /// # Errors
    /// When no status came back.
    pub(crate) fn request_models(&self) -> Result<HttpResponse, ureq::Error> {
        self.transport
            .get(&self.provider.base_url.with_path(self.provider.dialect.models_path()), &self.request_headers())
    }

    /// Makes a secure connection and asks for a page, without the key.
    ///
    /// # Errors
    /// When there is no connection, or it breaks.
    pub(crate) fn try_secure_connection(&self) -> Result<HttpResponse, ureq::Error> {
        self.transport.try_page(self.provider.base_url.as_str())
    }

    /// The headers of every request, with the key.
    fn request_headers(&self) -> Vec<(&'static str, String)> {
        let dialect = self.provider.dialect;
        let mut headers: Vec<_> =
            dialect.extra_headers().iter().map(|(name, value)| (*name, (*value).to_owned())).collect();
        if let Ok(Some(secret)) = self.find_secret() {
            let (name, prefix) = dialect.key_header();
            headers.push((name, secret.header_value(prefix)));
        }
        headers
    }
}

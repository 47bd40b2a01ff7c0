//! Turns flags and the settings file into the configuration for calls to models: providers, prices, rates, and the ledger that
//! keeps the calls.

use crate::{
    error::CommandError,
    settings::{CallKeeping, RunJob, Service},
    text_file,
};
use etcetera::BaseStrategy;
use std::path::PathBuf;
use wayword_ledger::Ledger;
use wayword_remote::{PriceTable, ProviderConfig, RemoteConfig, RequestConcurrency};

/// Most requests at a time to one provider, where the user gives no number: the program raises the number step by step
/// up to this.
const MAX_CONCURRENT_REQUESTS: usize = 64;

/// The path of the ledger: the one that a flag or the settings file gives, or else a file in the user's data folder. All runs share
/// that file, so that a run does not pay again for a call of an earlier run.
///
/// # Errors
/// When the user has no home folder.
pub fn ledger_path(service: &Service) -> Result<PathBuf, CommandError> {
    if let Some(path) = &service.ledger {
        return Ok(path.clone());
    }
    let strategy = etcetera::choose_base_strategy().map_err(|_| {
        CommandError::usage("there is no home folder to keep the ledger in", "name a file, as in --ledger calls.db")
    })?;
    Ok(strategy.data_dir().join("wayword").join("ledger.db"))
}

/// Refuses a place where calls cannot be kept. Does not open or make a file.
///
/// # Errors
/// When the ledger would be on a network file system, or the user has no home folder.
pub(super) fn check_call_store(keeping: &CallKeeping, service: &Service) -> Result<(), CommandError> {
    match keeping {
        CallKeeping::Machine => Ok(Ledger::check_place(&ledger_path(service)?)?),
        CallKeeping::Chunks(_) => Ok(()),
        #[cfg(feature = "queue")]
        CallKeeping::Database(..) => Ok(()),
    }
}

/// Opens the ledger that keeps the calls.
///
/// # Errors
/// When it cannot be opened, or the user has no home folder.
pub(super) fn open_ledger(keeping: &CallKeeping, service: &Service) -> Result<Ledger, CommandError> {
    Ok(match keeping {
        CallKeeping::Machine => Ledger::open(&ledger_path(service)?)?,
        CallKeeping::Chunks(recordings) => Ledger::in_chunks(recordings)?,
        #[cfg(feature = "queue")]
        CallKeeping::Database(database, lease) => Ledger::postgres_with_lease(database, *lease)?,
    })
}

/// The configuration for models over HTTP.
///
/// # Errors
/// When a provider's table or the list of prices cannot be read.
pub(super) fn service_config(
    RunJob { settings, service, providers, .. }: &RunJob,
) -> Result<RemoteConfig, CommandError> {
    let provider = |(name, table): (&String, &toml::Table)| -> Result<(String, ProviderConfig), CommandError> {
        let config = table.clone().try_into().map_err(|error: toml::de::Error| {
            CommandError::usage(format!("[providers.{name}]: {}", error.message()), "see docs/MODELS.md for the names")
        })?;
        Ok((name.clone(), config))
    };
    let default = RemoteConfig::default();
    Ok(RemoteConfig {
        providers: providers.iter().map(provider).collect::<Result<_, _>>()?,
        base_url: settings.roles.base_url.clone(),
        key_env: service.key_env.clone(),
        picture_px: settings.roles.picture_px,
        concurrency: service_concurrency(service),
        timeout_s: service.timeout_s.unwrap_or(default.timeout_s),
        requests_per_minute: service.requests_per_minute,
        tokens_per_minute: service.tokens_per_minute,
        prices: read_prices(service)?,
        needs_prices: service.max_usd.is_some(),
        ..default
    })
}

/// Requests at a time for each provider.
pub(super) fn service_concurrency(service: &Service) -> RequestConcurrency {
    service
        .concurrency
        .map_or(RequestConcurrency::Adaptive { most: MAX_CONCURRENT_REQUESTS }, RequestConcurrency::Fixed)
}

/// The user's list of prices, or the built-in one. The errors of a list end in a hint, which is split off here.
fn read_prices(service: &Service) -> Result<PriceTable, CommandError> {
    match &service.prices {
        None => Ok(PriceTable::built_in()),
        Some(file) => PriceTable::from_toml(&text_file::read_text_file(file, "read the prices")?).map_err(|error| {
            let error = error.to_string();
            let (problem, hint) = error.split_once("\nhint: ").unwrap_or((&error, "the format is in docs/MODELS.md"));
            CommandError::usage(format!("{}: {}", file.display(), problem.trim_end()), hint)
        }),
    }
}

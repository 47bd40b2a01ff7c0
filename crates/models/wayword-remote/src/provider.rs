//! Providers: merges the built-in table (`provider.toml`) with the user's settings, and checks the result.

use crate::{ConfigError, JsonMode, ProviderConfig, RemoteConfig, ServiceDialect, base_url::BaseUrl};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// The built-in table, as TOML.
const BUILT_IN: &str = include_str!("provider.toml");

/// Longest name of a model, bytes. A longer one is refused.
const MAX_NAME_BYTES: usize = 200;

/// The least context of a model, tokens: the shortest prompt to write, with its answer, takes about so many.
const MIN_CONTEXT_TOKENS: u64 = 1024;

/// A provider with all its settings. The fields are those of [`ProviderConfig`], with defaults filled in.
#[derive(Debug, Clone)]
pub(crate) struct RemoteProvider {
    pub(crate) name: String,
    pub(crate) dialect: ServiceDialect,
    pub(crate) base_url: BaseUrl,
    pub(crate) key_env: Option<String>,
    pub(crate) local: bool,
    pub(crate) blind: bool,
    pub(crate) context_tokens: Option<u64>,
    pub(crate) max_tokens_field: String,
    pub(crate) seed_field: String,
    pub(crate) extra: Map<String, Value>,
    pub(crate) omit: Vec<String>,
    pub(crate) json: JsonMode,
    pub(crate) tools: bool,
    pub(crate) requests_per_minute: Option<f64>,
    pub(crate) tokens_per_minute: Option<f64>,
    pub(crate) advertises_requests_per_day: bool,
}

/// All providers: the built-in ones, with the user's settings over them.
#[derive(Debug, Clone)]
pub(crate) struct ProviderTable(BTreeMap<String, ProviderConfig>);

/// The providers that come with the program.
///
/// The file is part of the program and a test reads it, so it cannot be wrong here.
pub(crate) fn built_in() -> BTreeMap<String, ProviderConfig> {
    toml::from_str(BUILT_IN).unwrap_or_default()
}

/// The provider and the model of a name. The model may contain slashes and colons.
///
/// # Errors
/// When there is no slash, a part is empty, or a character is not allowed in a name.
pub(crate) fn split_name(name: &str) -> Result<(&str, &str), ConfigError> {
    let odd = |part: &str| part.is_empty() || part.chars().any(|c| c.is_whitespace() || c.is_control());
    match name.split_once('/') {
        Some((provider, model)) if name.len() <= MAX_NAME_BYTES && !odd(provider) && !odd(model) => {
            Ok((provider, model))
        }
        _ => Err(ConfigError::Name(name.chars().take(MAX_NAME_BYTES).collect())),
    }
}

impl ProviderTable {
    /// The built-in table with the user's settings over it.
    pub(crate) fn new(settings: &BTreeMap<String, ProviderConfig>) -> Self {
        let mut table = built_in();
        for (name, config) in settings {
            let known = table.remove(name).unwrap_or_default();
            table.insert(name.clone(), known.overridden_by(config));
        }
        Self(table)
    }

    /// The providers' names.
    pub(crate) fn provider_names(&self) -> Vec<&str> {
        self.0.keys().map(String::as_str).collect()
    }

    /// A provider, with the settings for all providers applied.
    ///
    /// # Errors
    /// When there is no provider of that name, or one of its settings is missing or wrong.
    pub(crate) fn resolve_provider(&self, name: &str, config: &RemoteConfig) -> Result<RemoteProvider, ConfigError> {
        let settings = self.0.get(name).ok_or_else(|| ConfigError::NoProvider {
            provider: name.to_owned(),
            known: self.provider_names().join(", "),
        })?;
        let dialect = settings.dialect.ok_or_else(|| ConfigError::NoDialect(name.to_owned()))?;
        let url = config.base_url.as_ref().or(settings.base_url.as_ref());
        let url = url.ok_or_else(|| ConfigError::NoBaseUrl(name.to_owned()))?;
        let base_url = BaseUrl::new(url, dialect.default_version_path())
            .map_err(|problem| ConfigError::BaseUrl { provider: name.to_owned(), problem })?;
        let text = |field: &Option<String>, default: &str| field.clone().unwrap_or_else(|| default.to_owned());
        let provider = RemoteProvider {
            name: name.to_owned(),
            dialect,
            base_url,
            key_env: config.key_env.clone().or_else(|| settings.key_env.clone()),
            local: settings.local.unwrap_or(false),
            blind: settings.blind.unwrap_or(false) || !dialect.takes_pictures(),
            context_tokens: settings.context_tokens,
            max_tokens_field: text(&settings.max_tokens_field, "max_tokens"),
            seed_field: text(&settings.seed_field, "seed"),
            extra: settings.extra.clone().unwrap_or_default(),
            omit: settings.omit.clone().unwrap_or_default(),
            json: settings.json.unwrap_or_default(),
            tools: settings.tools.unwrap_or(false),
            requests_per_minute: settings.requests_per_minute.or(config.requests_per_minute),
            tokens_per_minute: settings.tokens_per_minute.or(config.tokens_per_minute),
            advertises_requests_per_day: settings.advertises_requests_per_day.unwrap_or(false),
        };
        provider.into_validated()
    }
}

impl RemoteProvider {
    /// Whether a sampling field is sent.
    pub(crate) fn sends_field(&self, field: &str) -> bool {
        !self.omit.iter().any(|omitted| omitted == field)
    }

    /// Checks the settings that could be wrong.
    fn into_validated(self) -> Result<Self, ConfigError> {
        let wrong = |field: &str, problem| ConfigError::Setting {
            setting: format!("providers.{}.{field}", self.name),
            problem,
        };
        for (field, rate) in
            [("requests_per_minute", self.requests_per_minute), ("tokens_per_minute", self.tokens_per_minute)]
        {
            if rate.is_some_and(|rate| !rate.is_finite() || rate <= 0.0) {
                return Err(wrong(field, "must be above 0"));
            }
        }
        if self.context_tokens.is_some_and(|tokens| tokens < MIN_CONTEXT_TOKENS) {
            return Err(wrong("context_tokens", "must be 1024 or more, since a prompt to write takes about so many"));
        }
        if self.omit.iter().any(|field| !["temperature", "seed", "max_tokens"].contains(&field.as_str())) {
            return Err(wrong("omit", "may contain only temperature, seed and max_tokens"));
        }
        let variable = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if self.key_env.as_ref().is_some_and(|name| name.is_empty() || !name.chars().all(variable)) {
            // The message leaves out the value, because a user may have put the key itself here, and it must not get
            // into a log.
            return Err(wrong("key_env", "is not the name of an environment variable (give the name, not the key)"));
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_table_is_read_and_complete() {
        let table: BTreeMap<String, ProviderConfig> = toml::from_str(BUILT_IN).unwrap();
        assert_eq!(table.len(), 15);
        let config = RemoteConfig::default();
        for name in table.keys().filter(|name| !["server", "completions"].contains(&name.as_str())) {
            let provider = ProviderTable::new(&config.providers).resolve_provider(name, &config).unwrap();
            assert_eq!(provider.local, provider.key_env.is_none(), "{name}");
            assert!(provider.local || !provider.base_url.plain, "{name}");
        }
    }

    #[test]
    fn split_accepts_models_with_slashes_and_colons() {
        assert_eq!(split_name("ollama/hf.co/owner/model:Q4").unwrap(), ("ollama", "hf.co/owner/model:Q4"));
        for name in ["qwen3", "/model", "ollama/", "ollama/a b", "ollama/a\nb", ""] {
            assert!(split_name(name).is_err(), "{name:?}");
        }
    }

    #[test]
    fn single_fields_are_overridden() {
        let config: RemoteConfig = toml::from_str("[providers.ollama]\nbase_url = \"http://10.0.0.7:11434\"").unwrap();
        let provider = ProviderTable::new(&config.providers).resolve_provider("ollama", &config).unwrap();
        assert_eq!(provider.base_url.as_str(), "http://10.0.0.7:11434");
        assert_eq!(provider.extra["think"], false);
        assert!(provider.local);
    }

    #[test]
    fn resolve_errors_name_the_missing_setting_and_its_flag() {
        let config = RemoteConfig::default();
        let table = ProviderTable::new(&config.providers);
        let error = table.resolve_provider("nobody", &config).unwrap_err().to_string();
        assert!(error.contains("there is no provider \"nobody\"") && error.contains("ollama, openai"), "{error}");
        let error = table.resolve_provider("server", &config).unwrap_err().to_string();
        assert!(error.contains("--base-url"), "{error}");
    }

    #[test]
    fn a_key_in_place_of_its_variable_is_refused_and_not_repeated() {
        let config = RemoteConfig { key_env: Some("sk-abc-123".to_owned()), ..RemoteConfig::default() };
        let error = ProviderTable::new(&config.providers).resolve_provider("openai", &config).unwrap_err().to_string();
        assert!(error.contains("not the key") && !error.contains("sk-abc"), "{error}");
    }
}

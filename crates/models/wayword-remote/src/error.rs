//! Errors in settings, with what to do about them.

/// A service cannot be used with these settings.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ConfigError {
    /// A name without a provider, or with odd characters.
    #[error("{0:?} is not the name of a model\nhint: write provider/model, like ollama/qwen3")]
    Name(String),
    /// A provider that is neither in the table nor in the settings.
    #[error(
        "there is no provider {provider:?}\nhint: choose one of {known}, or describe it under [providers.{provider}]"
    )]
    NoProvider {
        /// The given name.
        provider: String,
        /// All known providers.
        known: String,
    },
    /// A provider without a built-in address, and the user gave none.
    #[error(
        "the address of provider {0} is not known\nhint: give --base-url http://HOST:PORT/v1, or set base_url under [providers.{0}]"
    )]
    NoBaseUrl(String),
    /// A provider in the settings without a dialect.
    #[error(
        "provider {0} has no dialect\nhint: set dialect = \"openai\" (or completions, anthropic, gemini, ollama) under [providers.{0}]"
    )]
    NoDialect(String),
    /// A base URL that cannot be used.
    #[error("the base URL of {provider} {problem}\nhint: it looks like https://HOST/v1")]
    BaseUrl {
        /// The provider.
        provider: String,
        /// The problem. Never the URL, which may contain a password.
        problem: &'static str,
    },
    /// One base URL or key for several providers.
    #[error(
        "--base-url and --key-env apply to one provider, but the roles use {first} and {second}\nhint: set base_url and key_env under [providers.{first}] and [providers.{second}]"
    )]
    Several {
        /// The provider that was named first.
        first: String,
        /// The other provider.
        second: String,
    },
    /// A model that cannot be used at the moment.
    #[error("{problem}\nhint: {hint}")]
    NotReady {
        /// The missing part, and where it is expected.
        problem: String,
        /// How the user can fix it.
        hint: String,
    },
    /// There is a limit on money, and a model without a price.
    #[error(
        "the price of {0} is not known, so --max-usd cannot be enforced\nhint: give it with --prices FILE, where FILE has a row like \"{0}\" = {{ usd_per_million_in = 0.4, usd_per_million_out = 1.6, as_of = \"2026-11-01\" }}; if the model runs on this machine, set local = true under its [providers.NAME] in the --config file instead"
    )]
    NoPrice(String),
    /// A number or a name that is out of range or invalid.
    #[error("{setting} {problem}")]
    Setting {
        /// The setting.
        setting: String,
        /// The problem.
        problem: &'static str,
    },
}

/// A table of prices cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PricesError {
    /// The file is not a TOML table of prices.
    #[error(
        "prices: {0}\nhint: a row looks like \"provider/model\" = {{ usd_per_million_in = 0.5, usd_per_million_out = 1.5, as_of = \"2026-01-31\" }}"
    )]
    Toml(String),
    /// An amount is below 0, or not a number.
    #[error("prices: {0}: an amount is negative or not a number\nhint: give US dollars per million tokens")]
    Amount(String),
}

//! What can be wrong with settings, and what to do about it.

/// Services cannot be used as they were described.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ConfigError {
    /// A name without a provider, or with odd characters.
    #[error("{0:?} names no model\nhint: write provider/model, like ollama/qwen3")]
    Name(String),
    /// A provider that neither the table nor the settings hold.
    #[error(
        "there is no provider {provider:?}\nhint: name one of {known}, or describe it under [providers.{provider}]"
    )]
    NoProvider {
        /// As it was named.
        provider: String,
        /// All that there are.
        known: String,
    },
    /// A provider that can be anywhere, and nobody said where.
    #[error(
        "provider {0} needs to know where its server is\nhint: give --base-url http://HOST:PORT/v1, or base_url under [providers.{0}]"
    )]
    NoBaseUrl(String),
    /// A provider of the settings that says too little.
    #[error(
        "provider {0} has no dialect\nhint: set dialect = \"openai\" (or completions, anthropic, gemini, ollama) under [providers.{0}]"
    )]
    NoDialect(String),
    /// A base URL that is none.
    #[error("the base URL of {provider} {problem}\nhint: it looks like https://HOST/v1")]
    BaseUrl {
        /// Whose.
        provider: String,
        /// What is wrong with it. Never the URL, which may hold a password.
        problem: &'static str,
    },
    /// One base URL or key for several providers.
    #[error(
        "one base URL or key variable cannot be for both {first} and {second}\nhint: set base_url and key_env under [providers.{first}] and [providers.{second}]"
    )]
    Several {
        /// The provider that was named first.
        first: String,
        /// The other.
        second: String,
    },
    /// A model that cannot be asked at the moment.
    #[error("{problem}\nhint: {hint}")]
    NotReady {
        /// What is missing, and where.
        problem: String,
        /// What to do.
        hint: String,
    },
    /// A bound on money, and a model without a price.
    #[error(
        "nobody knows what {0} costs, so no bound on money can be kept\nhint: add a row for it to a file, and give it as --prices FILE; if it runs on this machine, set local = true under its [providers.NAME]"
    )]
    NoPrice(String),
    /// A number or a name that makes no sense.
    #[error("{setting} {problem}")]
    Setting {
        /// Which.
        setting: String,
        /// What is wrong with it.
        problem: &'static str,
    },
}

/// A table of prices cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PricesError {
    /// It is no TOML of this kind.
    #[error(
        "prices: {0}\nhint: a row looks like \"provider/model\" = {{ usd_per_million_in = 0.5, usd_per_million_out = 1.5, as_of = \"2026-01-31\" }}"
    )]
    Toml(String),
    /// An amount below nothing, or not a number.
    #[error("prices: {0}: an amount is negative or no number\nhint: give US dollars per million tokens")]
    Amount(String),
}

//! Models behind HTTP, as [`wayword_core::LanguageModel`]: OpenAI, Anthropic, Gemini, Ollama, and every service with
//! one of their APIs.
//!
//! Each dialect (API) is one file with two pure functions: one makes a request's body, one reads a reply's body. The
//! other parts are a transport, a module that classifies faults, a limiter for each endpoint, and the ledger, which
//! makes each call once.
//!
//! The crate `genai` does the same job. It is not used, because it reads a response's body without a limit, puts the
//! whole request with its pictures and the whole body into its errors, refuses JSON with another content type, has no
//! completions endpoint, and hides the headers of successful responses, so that advertised rate limits cannot be kept.
//!
//! Architecture invariant: a key is only in [`ServiceSecret`]'s module and in the header that carries it. It is removed
//! from every text of a server before anything else uses the text.
//!
//! # Where things are
//! - `provider.toml`, `prices.toml`: all providers, and all prices.
//! - `dialect/`: one file for each API, with its tools and structured answers.
//! - `faults/`: what a fault means (`mod.rs`, `error_body.rs`, `connection.rs`), what came in place of an answer (`unreadable.rs`), what to
//!   do about it (`hints.rs`), and how long the service asks to wait (`delay.rs`, `times.rs`).
//! - `first_calls`: the first call of a kind goes ahead alone.
//! - `limiter/`: how fast requests are sent.
//! - `check`, `ready`: what `doctor` and a run find out before the first call.
//! - `secret`: where a key comes from, and how it is removed from texts.

mod backoff;
mod base_url;
mod call;
mod check;
mod config;
mod dialect;
mod endpoint;
mod error;
mod faults;
mod first_calls;
mod limiter;
mod model;
mod picture;
mod prices;
mod provider;
mod ready;
mod secret;
mod services;
mod stream;
mod transport;

pub use check::{CheckLevel, ServiceFinding};
pub use config::{JsonMode, ProviderConfig, RemoteConfig, RequestConcurrency, ServiceDialect};
pub use error::{ConfigError, PricesError};
pub use model::RemoteModel;
pub use prices::{ModelPrice, PriceTable};
pub use secret::ServiceSecret;
pub use services::ModelServices;

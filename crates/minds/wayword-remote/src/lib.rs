//! Models behind HTTP, as [`wayword_core::LanguageModel`]: OpenAI, Anthropic, Gemini, Ollama, and whatever speaks like them.
//!
//! One file per dialect with two pure functions, request to wire and wire to reply; around them one transport, one place that
//! says what a fault means, one limiter per endpoint, and the ledger, which makes each call once.
//!
//! The crate `genai` would be the other way. It was not taken, because it reads a response's body without a bound, puts the
//! whole request with its pictures and the whole body into its errors, refuses JSON under another content type, hides the
//! headers of successful responses, so that advertised rate limits cannot be kept, and has no completions endpoint.
//!
//! Architecture invariant: a key lives in [`Secret`]'s module and in the header that carries it; every text that came from
//! a server is scrubbed of it before anybody sees it.

mod backoff;
mod base_url;
mod call;
mod check;
mod config;
mod dialect;
mod endpoint;
mod error;
mod faults;
mod limiter;
mod model;
mod picture;
mod prices;
mod provider;
mod ready;
mod secret;
mod services;
mod transport;

pub use check::{Finding, Level};
pub use config::{Concurrency, Config, ProviderConfig};
pub use dialect::Dialect;
pub use error::{ConfigError, PricesError};
pub use model::RemoteModel;
pub use prices::{Price, Prices};
pub use secret::Secret;
pub use services::Services;

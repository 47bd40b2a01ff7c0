//! Services that misbehave at the socket, and how a call then ends.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod faults;
mod keys;
mod server;
mod strays;
mod unreadable;
mod use_;

use server::Server;
use std::sync::Arc;
use wayword_core::{ChatMessage, ModelError, ModelReply, ModelRequest, SamplingOptions};
use wayword_ledger::{Ledger, LedgerRun, RunLimits};
use wayword_remote::{ModelServices, RemoteConfig, RemoteModel};

/// A run of a ledger in memory.
fn run() -> LedgerRun {
    Ledger::in_memory().unwrap().start_run("test", RunLimits::default()).unwrap()
}

/// A model of a server, with a user's settings as TOML.
fn model(server: &Server, settings: &str, run: &LedgerRun) -> Arc<RemoteModel> {
    services(server, settings, run).model("server/m").unwrap()
}

fn services(server: &Server, settings: &str, run: &LedgerRun) -> ModelServices {
    let mut config: RemoteConfig = toml::from_str(settings).unwrap();
    config.base_url = Some(server.base_url());
    ModelServices::new(config, run.clone()).unwrap()
}

fn ask(text: &str) -> ModelRequest {
    let sampling = SamplingOptions { temperature: 0.0, max_tokens: 20, seed: 1 };
    ModelRequest { messages: vec![ChatMessage::from_user(text)], sampling, replicate: 0, schema: None, tools: &[] }
}

/// The reply to one question.
fn asked(model: &RemoteModel, text: &str) -> Result<ModelReply, ModelError> {
    use wayword_core::LanguageModel;
    model.complete_requests(&[ask(text)]).pop().unwrap()
}

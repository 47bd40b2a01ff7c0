//! Services that misbehave at the socket, and how a call then ends.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod faults;
mod keys;
mod server;
mod use_;

use server::Server;
use std::sync::Arc;
use wayword_core::{Message, ModelError, Reply, Request, Sampling};
use wayword_ledger::{Ledger, Limits, Run};
use wayword_remote::{Config, RemoteModel, Services};

/// A run of a ledger in memory.
fn run() -> Run {
    Ledger::in_memory().unwrap().run("test", Limits::default()).unwrap()
}

/// A model of a server, with a user's settings as TOML.
fn model(server: &Server, settings: &str, run: &Run) -> Arc<RemoteModel> {
    services(server, settings, run).model("server/m").unwrap()
}

fn services(server: &Server, settings: &str, run: &Run) -> Services {
    let mut config: Config = toml::from_str(settings).unwrap();
    config.base_url = Some(server.base_url());
    Services::new(config, run.clone()).unwrap()
}

fn ask(text: &str) -> Request {
    let sampling = Sampling { temperature: 0.0, max_tokens: 20, seed: 1 };
    Request { messages: vec![Message::user(text)], sampling, replicate: 0, schema: None, tools: &[] }
}

/// The reply to one question.
fn asked(model: &RemoteModel, text: &str) -> Result<Reply, ModelError> {
    use wayword_core::LanguageModel;
    model.complete(&[ask(text)]).pop().unwrap()
}

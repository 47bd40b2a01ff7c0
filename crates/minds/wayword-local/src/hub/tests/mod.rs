//! The way to models, against a hub on this machine.

mod cache;
mod download;
mod fake;
mod names;
mod offline;
mod refusals;
mod server;

use super::{Hub, ModelFolder, ModelName, Needs};
use crate::LocalError;

/// The whole model, or what is wrong.
fn folder(hub: &Hub, name: &str) -> Result<ModelFolder, LocalError> {
    let name = ModelName::parse(name).unwrap();
    hub.folder(&name, &Needs::of_any(&name), &())
}

/// What is said of a model that cannot be had.
fn problem(hub: &Hub, name: &str) -> String {
    folder(hub, name).expect_err("it cannot be had").to_string()
}

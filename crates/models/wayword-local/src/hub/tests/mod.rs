//! Finding and fetching models, with a fake hub on this machine.

mod cache;
mod download;
mod fake;
mod names;
mod offline;
mod refusals;
mod server;
mod trust;

use super::{ModelFolder, ModelHub, ModelName, NeededFiles};
use crate::LocalError;

/// The folder of the whole model, or the error.
fn folder(hub: &ModelHub, name: &str) -> Result<ModelFolder, LocalError> {
    let name = ModelName::parse(name).unwrap();
    hub.model_folder(&name, &NeededFiles::for_any_architecture(&name), &())
}

/// The error for a model that cannot be found or fetched.
fn problem(hub: &ModelHub, name: &str) -> String {
    folder(hub, name).expect_err("it cannot be had").to_string()
}

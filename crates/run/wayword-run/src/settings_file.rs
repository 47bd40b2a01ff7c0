//! Reads the settings file of a command (`--config`).

use crate::{error::Error, settings::Asked, text_file};
use std::path::Path;

/// The settings in a file; all of them are empty if no file is given.
pub fn read(path: Option<&Path>) -> Result<Asked, Error> {
    let Some(path) = path else { return Ok(Asked::default()) };
    let text = text_file::read(path, "read the settings")?;
    toml::from_str(&text).map_err(|error| {
        Error::usage(
            format!("{}: {}", path.display(), error.to_string().trim()),
            "see wayword generate --help for the names, and docs/MODELS.md for [roles], [service] and [providers.NAME]",
        )
    })
}

/// How models are reached, from a settings file, for a command that ignores the other settings in it.
pub fn calls(path: Option<&Path>) -> Result<Asked, Error> {
    let Asked { service, providers, .. } = read(path)?;
    Ok(Asked { service, providers, ..Asked::default() })
}

//! Reads the settings file of a command (`--config`).

use crate::{error::CommandError, own_format, settings::AskedSettings, text_file};
use std::path::Path;

/// The settings in a file; all of them are empty if no file is given.
pub fn read_settings(path: Option<&Path>) -> Result<AskedSettings, CommandError> {
    let Some(path) = path else { return Ok(AskedSettings::default()) };
    let text = text_file::read_text_file(path, "read the settings")?;
    if own_format::is_run_record(&text) {
        return Err(CommandError::usage(
            format!("{}: it records the settings of a run, and is no settings file", path.display()),
            "to continue that run, give the command that began it; a settings file has the names of `wayword generate --help`",
        ));
    }
    toml::from_str(&text).map_err(|error| {
        CommandError::usage(
            format!("{}: {}", path.display(), error.to_string().trim()),
            "see wayword generate --help for the names, and docs/MODELS.md for [roles], [service] and [providers.NAME]",
        )
    })
}

/// How models are reached, from a settings file, for a command that ignores the other settings in it.
pub fn read_call_settings(path: Option<&Path>) -> Result<AskedSettings, CommandError> {
    let AskedSettings { service, providers, .. } = read_settings(path)?;
    Ok(AskedSettings { service, providers, ..AskedSettings::default() })
}

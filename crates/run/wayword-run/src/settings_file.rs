//! Reads the settings file of a command (`--config`).

use crate::{
    error::CommandError,
    own_format,
    settings::{AskedRoles, AskedSettings, Service},
    text_file,
    toml_message::plain_toml_message,
};
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
    if text.trim_start().starts_with(['{', '"']) || text.trim_start().starts_with("[{") {
        let problem = format!("{}: it looks like JSON, and settings are TOML", path.display());
        return Err(CommandError::usage(
            problem,
            "write lines as in paths = 20, with the names of `wayword generate --help`",
        ));
    }
    let is_style = |table: &toml::Table| table.contains_key("references") || table.contains_key("constraints");
    if text.parse::<toml::Table>().is_ok_and(|table| is_style(&table)) {
        let problem = format!("{}: it is a style, and --config takes settings", path.display());
        return Err(CommandError::usage(problem, format!("give it as --style {}", path.display())));
    }
    toml::from_str(&text).map_err(|error| {
        let told = error.to_string();
        let problem = format!("{}: {}", path.display(), plain_toml_message(&told));
        let unknown = told.split_once("unknown field `").and_then(|(_, after)| after.split('`').next());
        let hint = match unknown.and_then(|key| Some((key, table_of(key)?))) {
            Some((key, table)) => {
                format!("{} belongs into the table [{table}]: write it below a line [{table}]", key.replace('-', "_"))
            }
            None => "see wayword generate --help for the names, and docs/MODELS.md for [roles], [service] and [providers.NAME]"
                .to_owned(),
        };
        CommandError::usage(problem, hint)
    })
}

/// The table of a settings file that has this key, if one has it.
fn table_of(key: &str) -> Option<&'static str> {
    let key = key.replace('-', "_");
    let is_plain = key.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
    let line = format!("{key} = 0");
    // A key that the table has may still want another value than 0.
    let knows = |error: Option<toml::de::Error>| error.is_none_or(|error| !error.message().contains("unknown field"));
    if !is_plain {
        None
    } else if knows(toml::from_str::<AskedRoles>(&line).err()) {
        Some("roles")
    } else {
        knows(toml::from_str::<Service>(&line).err()).then_some("service")
    }
}

/// How models are reached, from a settings file, for a command that ignores the other settings in it.
pub fn read_call_settings(path: Option<&Path>) -> Result<AskedSettings, CommandError> {
    let AskedSettings { service, providers, .. } = read_settings(path)?;
    Ok(AskedSettings { service, providers, ..AskedSettings::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(text: &str) -> String {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("run.toml");
        std::fs::write(&file, text).unwrap();
        read_settings(Some(&file)).map_or_else(|error| error.to_string(), |_| String::new())
    }

    #[test]
    fn a_wrong_key_is_told_with_the_one_that_was_meant_or_its_table() {
        assert!(told("styl = ['r2r']").contains("did you mean \"style\"?"));
        assert!(told("per-path = 3").contains("did you mean \"per_path\"?"));
        for (key, table) in [
            ("llm = 'ollama/qwen3'", "roles"),
            ("max_usd = 2", "service"),
            ("max-usd = 2", "service"),
            ("write_sees = true", "roles"),
        ] {
            let told = told(key);
            assert!(told.contains(&format!("belongs into the table [{table}]")), "{told}");
        }
        assert!(told("[{\"scan\": \"s\"}]").contains("it looks like JSON") && told("{\"paths\": 3}").contains("TOML"));
        assert!(told("poem = 1").contains("see wayword generate --help"));
        assert_eq!(told("style = ['r2r']\n[roles]\nllm = 'ollama/qwen3'"), "");
    }
}

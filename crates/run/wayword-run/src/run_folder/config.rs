//! `config.toml` of a folder: the settings of its run, comparison or robustness test, with the format of the folder. The same
//! file decides whether a command continues the folder or is refused.

use super::{file, lines, setting_differences::setting_differences};
use crate::{
    count::count_phrase,
    error::CommandError,
    own_format::{self, OwnFormat},
    settings::RunSettings,
    text_file,
    written_files::write_file,
};
use serde::Serialize;
use std::path::Path;

/// Writes the settings into a new folder. In an old one, refuses settings that differ from those of the file.
pub fn keep_config<S>(folder: &Path, settings: &S) -> Result<(), CommandError>
where
    S: Serialize + OwnFormat + PartialEq,
{
    let path = folder.join(file::CONFIG);
    if !path.exists() {
        return write_config(&path, settings);
    }
    let before: S = read_config(folder)?;
    if before == *settings { Ok(()) } else { Err(other_settings(folder, &before, settings)) }
}

fn other_settings<S: Serialize>(folder: &Path, before: &S, settings: &S) -> CommandError {
    let differs = setting_differences(before, settings).join(", ");
    let problem = format!("{} holds a run with other settings: {differs}", folder.display());
    CommandError::usage(
        problem,
        "to continue it, give its own values as flags or in a settings file, and the same input files; for a new run, another --out",
    )
}

/// As [`keep_config`] for a run. Its number of paths or items may grow.
pub(super) fn keep_settings(folder: &Path, settings: &RunSettings) -> Result<(), CommandError> {
    let path = folder.join(file::CONFIG);
    if !path.exists() {
        return keep_config(folder, settings);
    }
    let before: RunSettings = read_config(folder)?;
    if before.raised_to(settings) != *settings {
        let as_many = RunSettings { paths: settings.paths, houses: settings.houses, ..before.clone() };
        let has_fewer_alone = settings.paths < before.paths && as_many.raised_to(settings) == *settings;
        return Err(match has_fewer_alone {
            true => fewer_paths(folder, &before, settings)?,
            false => other_settings(folder, &before, settings),
        });
    }
    if before == *settings { Ok(()) } else { write_config(&path, settings) }
}

/// The error about a run that is asked for fewer paths than it has. A run can be used as it is, however many of its items are made.
fn fewer_paths(folder: &Path, before: &RunSettings, settings: &RunSettings) -> Result<CommandError, CommandError> {
    let (shown, mut made) = (folder.display(), 0);
    lines::each_line(&folder.join(file::WALKS), |_| {
        made += 1;
        Ok(())
    })?;
    let problem = format!("{shown} holds a run of {} paths, but {} are asked for", before.paths, settings.paths);
    let hint = format!(
        "it need not be finished: `wayword report --run {shown}` and `wayword export --run {shown}` take what is there ({}); to \
         continue it, ask for {} or more; for a new run, give another --out",
        count_phrase(made, "item"),
        before.paths
    );
    Ok(CommandError::usage(problem, hint))
}

fn write_config<S: Serialize + OwnFormat>(path: &Path, settings: &S) -> Result<(), CommandError> {
    write_file(path, config_text(settings)?)
}

/// Settings as `config.toml` has them.
///
/// # Errors
/// When they cannot be written as TOML.
pub fn config_text<S: Serialize + OwnFormat>(settings: &S) -> Result<String, CommandError> {
    let text = toml::to_string_pretty(settings).map_err(|error| {
        CommandError::usage(format!("the settings cannot be written: {error}"), "report this as a bug")
    })?;
    Ok(own_format::with_header::<S>(&text))
}

/// Refuses a folder with a run in chunks that are not merged yet, because the files of the whole run are missing.
///
/// # Errors
/// When the run is not merged.
pub fn refuse_unmerged(folder: &Path) -> Result<(), CommandError> {
    if !is_begun(folder) && folder.join(wayword_queue::PLAN).exists() {
        return Err(CommandError::usage(
            format!("{}: this run lies in chunks", folder.display()),
            format!("put them together first: wayword runs merge {}", folder.display()),
        ));
    }
    Ok(())
}

/// Whether a folder holds a run, finished or not.
#[must_use]
pub fn is_begun(folder: &Path) -> bool {
    folder.join(file::CONFIG).exists()
}

/// The settings with which the run of a folder is continued: the new ones, with the scenes that it left out at first, and the
/// earlier numbers of paths.
///
/// # Errors
/// When the folder's settings cannot be read.
pub fn continued_settings(folder: &Path, settings: &RunSettings) -> Result<RunSettings, CommandError> {
    if !is_begun(folder) {
        return Ok(settings.clone());
    }
    let RunSettings { raised_from, left_out, .. } = read_config::<RunSettings>(folder)?.raised_to(settings);
    Ok(RunSettings { raised_from, left_out, ..settings.clone() })
}

/// The settings of a run.
///
/// # Errors
/// When the folder is not a run folder.
pub fn read_run_settings(folder: &Path) -> Result<RunSettings, CommandError> {
    refuse_unmerged(folder)?;
    read_config(folder)
}

/// Whether a folder holds a comparison of agents, finished or not, and not a run.
#[must_use]
pub fn is_comparison(folder: &Path) -> bool {
    read_config_table(folder).is_ok_and(|config| config.contains_key("agents"))
}

/// The table in `config.toml` of a folder, whatever its format.
fn read_config_table(folder: &Path) -> Result<toml::Table, CommandError> {
    let path = folder.join(file::CONFIG);
    let text = text_file::read_text_file(&path, "read the folder's settings")?;
    toml::from_str(&text).map_err(|error| {
        let problem = format!("{}: {}", path.display(), error.to_string().trim());
        CommandError::usage(problem, "it was changed by hand or by another program: use another folder")
    })
}

/// Refuses a folder of another format before one of its other files is read. A folder without settings passes.
///
/// # Errors
/// When `config.toml` cannot be read or names another format.
pub fn refuse_other_format<S: OwnFormat>(folder: &Path) -> Result<(), CommandError> {
    let path = folder.join(file::CONFIG);
    refuse_unmerged(folder)?;
    if !path.exists() {
        return Ok(());
    }
    let text = text_file::read_text_file(&path, "read the folder's settings")?;
    own_format::check_header::<S>(&text).map_err(|unread| {
        let hint = unread.hint_or("it was changed by hand or by another program: use another folder");
        CommandError::usage(format!("{}: {unread}", path.display()), hint)
    })
}

/// Reads `config.toml` of a folder.
pub fn read_config<S: OwnFormat>(folder: &Path) -> Result<S, CommandError> {
    let path = folder.join(file::CONFIG);
    let text = text_file::read_text_file(&path, "read the run's settings")?;
    own_format::parse_document(&text).map_err(|unread| {
        let hint = unread.hint_or("it was written by another command or another version: use another folder");
        CommandError::usage(format!("{}: {unread}", path.display()), hint)
    })
}

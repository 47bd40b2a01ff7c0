//! Splits an error into kind, problem, place and hint, for a program that this one runs in (the Python package).

use crate::error::{CommandError, Exit};
use std::{fmt::Display, path::Path};
use wayword_core::PlatformError;
use wayword_formats::{FormatError, disk_advice};
use wayword_world::mask_credentials;

/// The text before a hint in the errors of this program.
const HINT_PREFIX: &str = "\nhint: ";

/// An error in parts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ErrorParts {
    /// Its kind: `lost`, `stopped`, `busy` and `interrupted` as the exit codes have them; else the subject: `input`, `file`,
    /// `format`, `platform`, `style`, `model`, `ledger`, `walk` or `study`.
    pub kind: &'static str,
    /// The problem.
    pub what: String,
    /// Where: the file, and in it the item and field; or the scene.
    pub place: Option<String>,
    /// The hint, if there is one.
    pub hint: Option<String>,
}

impl ErrorParts {
    /// The parts of an error.
    #[must_use]
    pub fn from_error(error: &CommandError) -> Self {
        let Self { kind, what, place, hint } = Self::with_credentials(error);
        let masked = |text: String| mask_credentials(&text).into_owned();
        Self { kind, what: masked(what), place: place.map(masked), hint: hint.map(masked) }
    }

    /// The parts, with the secrets that addresses in them may hold.
    fn with_credentials(error: &CommandError) -> Self {
        let kind = error_kind(error);
        let at_place = |place: &Path, what: &dyn Display, hint: &str| Self {
            kind,
            what: what.to_string(),
            place: Some(place.display().to_string()),
            hint: (!hint.is_empty()).then(|| hint.to_owned()),
        };
        match error {
            CommandError::Format(FormatError::Io { file, doing, source }) => {
                let is_missing = source.kind() == std::io::ErrorKind::NotFound;
                let hint = disk_advice(source).or(is_missing.then_some("check the spelling of the path"));
                let hint = hint.unwrap_or_default();
                at_place(file, &format!("cannot {doing} it: {source}"), hint)
            }
            CommandError::Format(FormatError::Document { file, problem, hint }) => at_place(file, problem, hint),
            CommandError::Format(FormatError::Item(wrong)) => {
                let id = wrong.id.as_ref().map_or_else(String::new, |id| format!(" (id {id})"));
                let place = format!("{}: {}{id}: field \"{}\"", wrong.file.display(), wrong.place, wrong.field);
                at_place(place.as_ref(), &wrong.problem, wrong.hint)
            }
            CommandError::Platform(PlatformError::File { file, reason, hint }) => at_place(file, reason, hint),
            CommandError::Platform(PlatformError::NoFile { file, hint }) => {
                at_place(file, &"there is no such file", hint)
            }
            CommandError::Platform(PlatformError::Lost { world, reason, hint }) => {
                at_place(world.as_ref(), reason, hint)
            }
            CommandError::Platform(PlatformError::UnknownScene { scene, hint }) => {
                at_place(scene.as_ref(), &"there is no such scene", hint)
            }
            CommandError::Platform(PlatformError::NoSuchPath { scene, request, hint }) => {
                at_place(scene.as_str().as_ref(), &format!("the scene has no path with {request}"), hint)
            }
            error => {
                let text = error.to_string();
                let (what, hint) =
                    text.split_once(HINT_PREFIX).map_or((&*text, None), |(what, hint)| (what, Some(hint)));
                let place = error_file(error).map(|file| file.display().to_string());
                Self { kind, what: what.to_owned(), place, hint: hint.map(str::to_owned) }
            }
        }
    }
}

/// The file or folder that an error is about.
fn error_file(error: &CommandError) -> Option<&Path> {
    match error {
        CommandError::Io { path, .. } => Some(path),
        CommandError::Busy(folder) | CommandError::BusyElsewhere { folder, .. } => Some(folder),
        CommandError::ChangedScene { record, .. } => Some(record),
        _ => None,
    }
}

/// The kind of an error, as [`ErrorParts::kind`] lists them.
fn error_kind(error: &CommandError) -> &'static str {
    match error.exit_code() {
        Exit::Lost => return "lost",
        Exit::Stopped => return "stopped",
        Exit::Busy => return "busy",
        Exit::Interrupted => return "interrupted",
        Exit::Done | Exit::BadInput | Exit::WithLoss => {}
    }
    match error {
        error if error.platform_error().is_some() => "platform",
        error if error.model_error().is_some() => "model",
        CommandError::Format(FormatError::Io { .. }) => "file",
        CommandError::Format(_) => "format",
        CommandError::Style(_) | CommandError::Prompt(_) => "style",
        CommandError::Model(_) | CommandError::Observe(_) | CommandError::Service(_) => "model",
        #[cfg(feature = "local")]
        CommandError::Local(_) => "model",
        CommandError::Ledger(_) => "ledger",
        #[cfg(feature = "queue")]
        CommandError::Database(_) => "ledger",
        CommandError::Queue(_) => "file",
        #[cfg(feature = "experiments")]
        CommandError::Walk(_) => "walk",
        #[cfg(feature = "study")]
        CommandError::Study(_) => "study",
        CommandError::House(_) | CommandError::Io { .. } => "file",
        CommandError::Usage { .. } | CommandError::Launch(_) => "input",
        CommandError::Platform(_) | CommandError::ChangedScene { .. } => "platform",
        // The exit codes above have handled these.
        CommandError::Interrupted | CommandError::Busy(_) | CommandError::BusyElsewhere { .. } => "input",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_error_splits_errors_into_problem_place_and_hint() {
        let usage = ErrorParts::from_error(&CommandError::usage("there is no scene", "name one"));
        assert_eq!((usage.kind, &*usage.what, usage.hint.as_deref()), ("input", "there is no scene", Some("name one")));
        let missing =
            wayword_formats::read_any_format(Path::new("nowhere.json")).map_err(CommandError::from).unwrap_err();
        let missing = ErrorParts::from_error(&missing);
        assert_eq!((missing.kind, missing.place.as_deref()), ("file", Some("nowhere.json")));
        let file = tempfile::NamedTempFile::with_suffix(".json").unwrap();
        std::fs::write(
            file.path(),
            r#"[{"path_id": 1, "scan": "s", "path": ["a"], "heading": "x", "instructions": ["Go."]}]"#,
        )
        .unwrap();
        let item = ErrorParts::from_error(
            &wayword_formats::read_any_format(file.path()).map_err(CommandError::from).unwrap_err(),
        );
        let place = item.place.unwrap();
        assert!(place.contains("item 0 (id 1): field \"heading\"") && item.hint.is_some(), "{place}: {}", item.what);
    }
}

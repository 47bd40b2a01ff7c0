//! Splits an error into kind, problem, place and hint, for a program that this one runs in (the Python package).

use crate::error::{Error, Exit};
use std::{fmt::Display, path::Path};
use wayword_core::PlatformError;
use wayword_formats::FormatError;

/// The text before a hint in the errors of this program.
const HINT: &str = "\nhint: ";

/// An error in parts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Explained {
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

impl Explained {
    /// The parts of an error.
    #[must_use]
    pub fn of(error: &Error) -> Self {
        let kind = kind(error);
        let at = |place: &Path, what: &dyn Display, hint: &str| Self {
            kind,
            what: what.to_string(),
            place: Some(place.display().to_string()),
            hint: (!hint.is_empty()).then(|| hint.to_owned()),
        };
        match error {
            Error::Format(FormatError::Io { file, doing, source }) => {
                let is_missing = source.kind() == std::io::ErrorKind::NotFound;
                let hint = if is_missing { "check the spelling of the path" } else { "" };
                at(file, &format!("cannot {doing} it: {source}"), hint)
            }
            Error::Format(FormatError::Document { file, problem, hint }) => at(file, problem, hint),
            Error::Format(FormatError::Item(wrong)) => {
                let id = wrong.id.as_ref().map_or_else(String::new, |id| format!(" (id {id})"));
                let place = format!("{}: {}{id}: field \"{}\"", wrong.file.display(), wrong.place, wrong.field);
                at(place.as_ref(), &wrong.problem, wrong.hint)
            }
            Error::Platform(PlatformError::File { file, reason, hint }) => at(file, reason, hint),
            Error::Platform(PlatformError::NoFile { file, hint }) => at(file, &"there is no such file", hint),
            Error::Platform(PlatformError::Lost { world, reason, hint }) => at(world.as_ref(), reason, hint),
            Error::Platform(PlatformError::UnknownScene { scene, hint }) => {
                at(scene.as_ref(), &"there is no such scene", hint)
            }
            Error::Platform(PlatformError::NoSuchPath { scene, request, hint }) => {
                at(scene.as_str().as_ref(), &format!("the scene has no path with {request}"), hint)
            }
            error => {
                let told = error.to_string();
                let (what, hint) = told.split_once(HINT).map_or((&*told, None), |(what, hint)| (what, Some(hint)));
                let place = file_of(error).map(|file| file.display().to_string());
                Self { kind, what: what.to_owned(), place, hint: hint.map(str::to_owned) }
            }
        }
    }
}

/// The file or folder that an error is about.
fn file_of(error: &Error) -> Option<&Path> {
    match error {
        Error::Io { path, .. } => Some(path),
        Error::Busy(folder) | Error::BusyElsewhere { folder, .. } => Some(folder),
        Error::ChangedScene { record, .. } => Some(record),
        _ => None,
    }
}

/// The kind of an error, as [`Explained::kind`] lists them.
fn kind(error: &Error) -> &'static str {
    use wayword_navigation::WalkError;
    use wayword_synthesis::observe::ObserveError;
    match error.exit_code() {
        Exit::Lost => return "lost",
        Exit::Stopped => return "stopped",
        Exit::Busy => return "busy",
        Exit::Interrupted => return "interrupted",
        Exit::Done | Exit::BadInput | Exit::WithLoss => {}
    }
    match error {
        Error::Platform(_) | Error::Observe(ObserveError::Platform(_)) | Error::Walk(WalkError::Platform(_)) => {
            "platform"
        }
        Error::Format(FormatError::Io { .. }) => "file",
        Error::Format(_) => "format",
        Error::Style(_) | Error::Prompt(_) => "style",
        Error::Model(_)
        | Error::Observe(ObserveError::Model(_))
        | Error::Walk(WalkError::Model(_))
        | Error::Service(_) => "model",
        #[cfg(feature = "local")]
        Error::Local(_) => "model",
        Error::Ledger(_) => "ledger",
        #[cfg(feature = "queue")]
        Error::Database(_) => "ledger",
        Error::Queue(_) => "file",
        Error::Walk(_) => "walk",
        #[cfg(feature = "study")]
        Error::Study(_) => "study",
        Error::House(_) | Error::Io { .. } => "file",
        Error::Usage { .. } | Error::Launch(_) => "input",
        Error::ChangedScene { .. } => "platform",
        // The exit codes above have handled these.
        Error::Interrupted | Error::Busy(_) | Error::BusyElsewhere { .. } => "input",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_error_splits_errors_into_problem_place_and_hint() {
        let usage = Explained::of(&Error::usage("there is no scene", "name one"));
        assert_eq!((usage.kind, &*usage.what, usage.hint.as_deref()), ("input", "there is no scene", Some("name one")));
        let missing = wayword_formats::read(Path::new("nowhere.json")).map_err(Error::from).unwrap_err();
        let missing = Explained::of(&missing);
        assert_eq!((missing.kind, missing.place.as_deref()), ("file", Some("nowhere.json")));
        let file = tempfile::NamedTempFile::with_suffix(".json").unwrap();
        std::fs::write(
            file.path(),
            r#"[{"path_id": 1, "scan": "s", "path": ["a"], "heading": "x", "instructions": ["Go."]}]"#,
        )
        .unwrap();
        let item = Explained::of(&wayword_formats::read(file.path()).map_err(Error::from).unwrap_err());
        let place = item.place.unwrap();
        assert!(place.contains("item 0 (id 1): field \"heading\"") && item.hint.is_some(), "{place}: {}", item.what);
    }
}

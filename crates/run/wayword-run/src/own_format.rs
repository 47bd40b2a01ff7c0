//! The TOML files that this program writes and reads again. Two keys at the head of each file name its format and the version of
//! the program that wrote it, so that a later version can refuse a file that it would misread. docs/FORMATS.md describes what
//! later versions promise to read.

use crate::settings::RunSettings;
use serde::de::DeserializeOwned;
use toml::{Table, Value};
use wayword_checks::{detection::DetectorFigures, open::Calibration};

/// The key of the format.
const FORMAT_KEY: &str = "format";
/// The key of the version of the program.
const WRITER_KEY: &str = "wayword";
/// Longest name of a format or a version that an error repeats, characters. The rest is cut off.
const MAX_SHOWN_CHARS: usize = 60;

/// The content of a file that begins with the two keys (its head). A file without a head is accepted as well: the first
/// versions of this program wrote none.
pub trait OwnFormat: DeserializeOwned {
    /// The name and the version of the format.
    const NAME: &str;
    /// The format's number in old files, from before formats had names; `None` for a format that never had a number.
    const NUMBER: Option<i64> = None;
}

impl OwnFormat for RunSettings {
    const NAME: &str = "wayword-run/1";
}

impl OwnFormat for Calibration {
    const NAME: &str = "wayword-calibration/1";
}

impl OwnFormat for DetectorFigures {
    const NAME: &str = "wayword-detector-figures/1";
}

/// Why a file of this program cannot be used.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum OwnFormatError {
    /// Another command wrote the file.
    #[error("`wayword {by}` wrote it, and here it has to be of `wayword {wanted}`")]
    OfCommand {
        /// The command that wrote it.
        by: &'static str,
        /// The command that made the files which are read here.
        wanted: &'static str,
    },
    /// The file has another format than the one that is read.
    #[error("its format is {found}{}, and this is version {}, which reads {known}", .by.as_ref().map_or_else(String::new, |by| format!(" and version {by} of this program wrote it")), env!("CARGO_PKG_VERSION"))]
    Other {
        /// The format that the file names.
        found: String,
        /// The version of this program that wrote the file, if the file names it.
        by: Option<String>,
        /// The format that is read here.
        known: &'static str,
    },
    /// It is not TOML, or a field of the format is missing or wrong.
    #[error("{0}")]
    Broken(String),
}

impl OwnFormatError {
    /// The hint for the user. `otherwise` is the hint for a broken file, which depends on the kind of file.
    pub(crate) fn hint_or<'a>(&self, otherwise: &'a str) -> &'a str {
        match self {
            Self::OfCommand { .. } => "give another file or folder; for a new result, another --out",
            Self::Other { .. } => "use the version that wrote it, or give another file or folder",
            Self::Broken(_) => otherwise,
        }
    }
}

/// The families of formats, each with the command that writes it.
const WRITTEN_BY: [(&str, &str); 6] = [
    ("wayword-run", "generate"),
    ("wayword-comparison", "compare"),
    ("wayword-robustness", "robustness"),
    ("wayword-calibration", "calibrate"),
    ("wayword-detector-figures", "perceive"),
    ("wayword-steps", "export"),
];

/// The command that writes a format, whatever its number.
fn command_of(format: &str) -> Option<&'static str> {
    let family = format.split('/').next();
    WRITTEN_BY.iter().find(|(known, _)| family == Some(*known)).map(|(_, command)| *command)
}

/// The text of a file with the content `body`, below its head.
pub fn with_header<S: OwnFormat>(body: &str) -> String {
    format!("{FORMAT_KEY} = \"{}\"\n{WRITER_KEY} = \"{}\"\n{body}", S::NAME, env!("CARGO_PKG_VERSION"))
}

/// Whether a text records the settings of a run, of this version or another.
pub(crate) fn is_run_record(text: &str) -> bool {
    let table: Option<Table> = toml::from_str(text).ok();
    let format = table.as_ref().and_then(|table| table.get(FORMAT_KEY)?.as_str());
    format.is_some_and(|format| format.split('/').next() == RunSettings::NAME.split('/').next())
}

/// Reads the content of a file.
///
/// # Errors
/// When it is not TOML, has another format, or breaks its own.
pub(crate) fn parse_document<S: OwnFormat>(text: &str) -> Result<S, OwnFormatError> {
    parse_body::<S>(text)?.try_into().map_err(|error| OwnFormatError::Broken(error.to_string().trim().to_owned()))
}

/// Checks only the head of a file.
///
/// # Errors
/// When it is not TOML, or has another format.
pub(crate) fn check_header<S: OwnFormat>(text: &str) -> Result<(), OwnFormatError> {
    parse_body::<S>(text).map(drop)
}

/// The table below the head, after a check that the format is the right one.
fn parse_body<S: OwnFormat>(text: &str) -> Result<Table, OwnFormatError> {
    let mut table: Table =
        toml::from_str(text).map_err(|error| OwnFormatError::Broken(error.to_string().trim().to_owned()))?;
    let by = table.remove(WRITER_KEY);
    match table.remove(FORMAT_KEY) {
        None => Ok(table),
        Some(Value::String(format)) if format == S::NAME => Ok(table),
        Some(Value::Integer(number)) if S::NUMBER == Some(number) => Ok(table),
        Some(found) => {
            let commands = found.as_str().and_then(command_of).zip(command_of(S::NAME));
            if let Some((by, wanted)) = commands.filter(|(by, wanted)| by != wanted) {
                return Err(OwnFormatError::OfCommand { by, wanted });
            }
            Err(OwnFormatError::Other { found: short_value(&found), by: by.as_ref().map(short_value), known: S::NAME })
        }
    }
}

/// A value of the head as text, cut so that an error stays short.
fn short_value(value: &Value) -> String {
    value.to_string().chars().take(MAX_SHOWN_CHARS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const BODY: &str = "detector = \"hf/a\"\nplatforms = []\nfound_from = 0.5\n[all]\nshown = 1\nfound = 1\nabsent = 1\n\
                        alarms = 1\nmissed_before = 1\nmissed_again = 1\nruns = [1]\n";

    fn figures(text: &str) -> Result<DetectorFigures, OwnFormatError> {
        parse_document(text)
    }

    #[test]
    fn parse_document_accepts_its_own_head_and_files_without_a_head() {
        let written = with_header::<DetectorFigures>(BODY);
        assert!(written.starts_with("format = \"wayword-detector-figures/1\"\nwayword = \""), "{written}");
        assert_eq!(figures(&written).unwrap(), figures(BODY).unwrap());
    }

    #[test]
    fn a_later_format_is_refused_with_the_version_that_wrote_it() {
        let later = with_header::<DetectorFigures>(BODY)
            .replace("figures/1", "figures/2")
            .replace(env!("CARGO_PKG_VERSION"), "7.0.3");
        let told = figures(&later).unwrap_err().to_string();
        assert!(
            ["\"wayword-detector-figures/2\"", "7.0.3", "reads wayword-detector-figures/1"]
                .iter()
                .all(|part| told.contains(part)),
            "{told}"
        );
        let other = figures(&with_header::<RunSettings>(BODY)).unwrap_err();
        assert!(matches!(&other, OwnFormatError::OfCommand { .. }), "another kind of file: {other}");
        assert!(other.hint_or("").contains("give another file or folder"), "{}", other.hint_or(""));
    }

    #[test]
    fn a_format_that_is_no_name_is_refused_and_not_repeated_at_length() {
        let told = figures(&format!("format = \"{}\"", "x".repeat(5000))).unwrap_err().to_string();
        assert!(told.len() < 300, "{told}");
        assert!(matches!(figures("format = 1"), Err(OwnFormatError::Other { .. })));
        assert!(matches!(figures("format = "), Err(OwnFormatError::Broken(_))));
    }
}

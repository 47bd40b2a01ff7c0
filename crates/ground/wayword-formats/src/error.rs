//! The errors for refused files: they name the file, the item and the field, and give advice.

use std::{
    fmt,
    path::{Path, PathBuf},
};

/// A dataset file cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// The operating system could not open, read or write the file.
    #[error("{}: cannot {doing} it: {source}{}", file.display(), io_advice(doing, source))]
    Io {
        /// Which file.
        file: PathBuf,
        /// The operation ("open", "write").
        doing: &'static str,
        /// The system's error.
        source: std::io::Error,
    },
    /// The file as a whole does not have the form that it should have.
    #[error("{}: {problem}; {hint}", file.display())]
    Document {
        /// Which file.
        file: PathBuf,
        /// The problem, in words.
        problem: String,
        /// Advice for the user.
        hint: &'static str,
    },
    /// One of its items is wrong.
    #[error(transparent)]
    Item(#[from] Box<WrongItem>),
}

/// An item of a dataset file is refused.
#[derive(Debug, thiserror::Error)]
#[error("{}: {place}{}: field \"{field}\": {problem}; {hint}", file.display(), IdSuffix(id.as_deref()))]
pub struct WrongItem {
    /// Which file.
    pub file: PathBuf,
    /// Where in the file.
    pub place: ItemPlace,
    /// The item's own id, where it could be read.
    pub id: Option<String>,
    /// The field, with the index or key within it (`path[3]`).
    pub field: String,
    /// The problem, in words.
    pub problem: String,
    /// Advice for the user.
    pub hint: &'static str,
}

/// The place of an item in its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ItemPlace {
    /// Its index in a JSON list, from 0.
    Item(usize),
    /// Its line in a JSON Lines file, from 1.
    Line(usize),
}

impl fmt::Display for ItemPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Item(index) => write!(f, "item {index}"),
            Self::Line(number) => write!(f, "line {number}"),
        }
    }
}

/// Advice about an error of the system, after a semicolon; empty where its message is enough.
fn io_advice(doing: &str, error: &std::io::Error) -> String {
    let advice = match (error.kind(), doing) {
        (std::io::ErrorKind::NotFound, "write") => Some("its folder is not there: make it, or correct the path"),
        (std::io::ErrorKind::IsADirectory, "write") => Some("it is a folder: give the name of a file"),
        (std::io::ErrorKind::NotFound, _) => Some("check the spelling of the path"),
        _ => disk_advice(error),
    };
    advice.map_or_else(String::new, |advice| format!("; {advice}"))
}

/// Advice where the disk is full, a quota is used up, or a file is larger than the user's limit allows.
#[must_use]
pub fn disk_advice(error: &std::io::Error) -> Option<&'static str> {
    match error.kind() {
        std::io::ErrorKind::StorageFull => Some("free some space, and give the same command again"),
        std::io::ErrorKind::QuotaExceeded => {
            Some("your quota on this disk is used up: free some space, and give the same command again")
        }
        std::io::ErrorKind::FileTooLarge => Some(
            "the file is larger than your limit (`ulimit -f`) or the disk allows: raise the limit, and give the same command again",
        ),
        _ => None,
    }
}

/// The item's id in brackets, for a message; nothing where it is not known.
struct IdSuffix<'a>(Option<&'a str>);

impl fmt::Display for IdSuffix<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |id| write!(f, " (id {id})"))
    }
}

impl FormatError {
    pub(crate) fn from_io(file: &Path, doing: &'static str, source: std::io::Error) -> Self {
        Self::Io { file: file.to_owned(), doing, source }
    }

    pub(crate) fn for_document(file: &Path, problem: impl Into<String>, hint: &'static str) -> Self {
        Self::Document { file: file.to_owned(), problem: problem.into(), hint }
    }

    /// The file that it is about.
    #[must_use]
    pub fn file(&self) -> &Path {
        match self {
            Self::Io { file, .. } | Self::Document { file, .. } => file,
            Self::Item(item) => &item.file,
        }
    }
}

//! Why a file is refused: which file, which item, which field, and what to do.

use std::{
    fmt,
    path::{Path, PathBuf},
};

/// A dataset file cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// The operating system could not open, read or write the file.
    #[error("{}: cannot {doing} it: {source}{}", file.display(), advice(source))]
    Io {
        /// Which file.
        file: PathBuf,
        /// What was tried ("open", "write").
        doing: &'static str,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file as a whole is not what it should be.
    #[error("{}: {problem}; {hint}", file.display())]
    Document {
        /// Which file.
        file: PathBuf,
        /// What is wrong with it.
        problem: String,
        /// What to do.
        hint: &'static str,
    },
    /// One of its items is wrong.
    #[error(transparent)]
    Item(#[from] Box<WrongItem>),
}

/// An item of a dataset file is refused.
#[derive(Debug, thiserror::Error)]
#[error("{}: {place}{}: field \"{field}\": {problem}; {hint}", file.display(), Named(id.as_deref()))]
pub struct WrongItem {
    /// Which file.
    pub file: PathBuf,
    /// Where in the file.
    pub place: ItemPlace,
    /// The item's own id, where it could be read.
    pub id: Option<String>,
    /// The field, with the index or key within it (`path[3]`).
    pub field: String,
    /// What is wrong with it.
    pub problem: String,
    /// What to do.
    pub hint: &'static str,
}

/// Where an item stands in its file.
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

/// What to do about an error of the system, after a semicolon; empty where its message is enough.
fn advice(error: &std::io::Error) -> &'static str {
    if error.kind() == std::io::ErrorKind::NotFound { "; check the spelling of the path" } else { "" }
}

struct Named<'a>(Option<&'a str>);

impl fmt::Display for Named<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |id| write!(f, " (id {id})"))
    }
}

impl FormatError {
    pub(crate) fn io(file: &Path, doing: &'static str, source: std::io::Error) -> Self {
        Self::Io { file: file.to_owned(), doing, source }
    }

    pub(crate) fn document(file: &Path, problem: impl Into<String>, hint: &'static str) -> Self {
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

//! What can go wrong with a model in process.

use std::{path::PathBuf, sync::Arc};

/// A model cannot be had, or cannot do what it was asked.
#[derive(Debug, Clone, thiserror::Error)]
pub enum LocalError {
    /// A name that is none.
    #[error(
        "{name:?} is no model in process: {problem}\nhint: names are hf/ORG/NAME, hf/ORG/NAME@REVISION, or hf/PATH of a local folder that begins with / or ."
    )]
    Name {
        /// What was given.
        name: String,
        /// What is wrong with it.
        problem: String,
    },
    /// A file that has to be there is not.
    #[error("{}: {what} is missing\nhint: {hint}", file.display())]
    Missing {
        /// Where it should be.
        file: PathBuf,
        /// What it is.
        what: &'static str,
        /// How to get it.
        hint: String,
    },
    /// A file would not be read or written.
    #[error("{}: cannot {doing}: {source}\nhint: see whether the file or its folder is there, may be used, and has room", file.display())]
    Io {
        /// The file.
        file: PathBuf,
        /// What was tried.
        doing: &'static str,
        /// What the system said.
        source: Arc<std::io::Error>,
    },
    /// A file is not what its name says.
    #[error("{}: {problem}\nhint: {hint}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// What is wrong, with field or place.
        problem: String,
        /// What to do.
        hint: &'static str,
    },
    /// A tensor of a checkpoint is missing or wrong.
    #[error("{}: tensor {tensor}: {problem}\nhint: the checkpoint is cut off or of another architecture; fetch it again, or name another model", file.display())]
    Tensor {
        /// The checkpoint.
        file: PathBuf,
        /// The tensor.
        tensor: String,
        /// What is wrong with it.
        problem: String,
    },
    /// The network did not give a file.
    #[error("{address}: {problem}\nhint: {hint}")]
    Download {
        /// What was asked for.
        address: String,
        /// What happened.
        problem: String,
        /// What to do.
        hint: String,
    },
    /// The computation failed.
    #[error("{model}: {problem}")]
    Compute {
        /// Which model.
        model: String,
        /// What happened.
        problem: String,
    },
}

impl LocalError {
    pub(crate) fn io(file: impl Into<PathBuf>, doing: &'static str, source: std::io::Error) -> Self {
        Self::Io { file: file.into(), doing, source: Arc::new(source) }
    }

    pub(crate) fn download(address: impl Into<String>, problem: impl Into<String>, hint: impl Into<String>) -> Self {
        Self::Download { address: address.into(), problem: problem.into(), hint: hint.into() }
    }

    pub(crate) fn compute(model: &str, error: &candle_core::Error) -> Self {
        // candle's errors may carry a backtrace.
        let problem = error.to_string().lines().next().unwrap_or("the computation failed").to_owned();
        Self::Compute { model: model.to_owned(), problem }
    }

    pub(crate) fn tensor(file: impl Into<PathBuf>, tensor: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Tensor { file: file.into(), tensor: tensor.into(), problem: problem.into() }
    }
}

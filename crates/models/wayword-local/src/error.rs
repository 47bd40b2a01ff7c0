//! The error type of this crate. Each message ends with a hint that names the next step.

use std::{path::PathBuf, sync::Arc};

/// The hint for a damaged file. The user must delete its folder first, because a fetch downloads only files that the
/// cache lacks.
pub(crate) const FETCH_AGAIN: &str = "fetch it again: delete the folder models--ORG--NAME that holds it, and run `wayword models fetch hf/ORG/NAME`; if the folder is your own, copy the file into it again";

/// A model cannot be found, fetched, loaded or computed.
#[derive(Debug, Clone, thiserror::Error)]
pub enum LocalError {
    /// The name of a model is not valid.
    #[error(
        "{name:?} is not the name of a model in process: {problem}\nhint: names are hf/ORG/NAME, hf/ORG/NAME@REVISION, hf/ORG/NAME@REVISION:FILE, or hf/PATH of a local folder that begins with / or ."
    )]
    Name {
        /// The name that the user gave.
        name: String,
        /// What is wrong with it.
        problem: String,
    },
    /// A required file is missing.
    #[error("{}: {what} is missing\nhint: {hint}", file.display())]
    Missing {
        /// Its path.
        file: PathBuf,
        /// Its purpose, as in "the tokenizer".
        what: &'static str,
        /// How to get it.
        hint: String,
    },
    /// A file operation failed.
    #[error("{}: cannot {doing}: {source}\nhint: check that the file or its folder exists, that you may use it, and that the disk has room", file.display())]
    Io {
        /// The file.
        file: PathBuf,
        /// The operation, as in "read".
        doing: &'static str,
        /// The system's error.
        source: Arc<std::io::Error>,
    },
    /// A file has the wrong content.
    #[error("{}: {problem}\nhint: {hint}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// The problem, with the field or the position in the file.
        problem: String,
        /// What to do.
        hint: &'static str,
    },
    /// A tensor of a checkpoint is missing or wrong.
    #[error("{}: tensor {tensor}: {problem}\nhint: the checkpoint is cut off or of another architecture; choose another model, or {FETCH_AGAIN}", file.display())]
    Tensor {
        /// The checkpoint.
        file: PathBuf,
        /// The tensor.
        tensor: String,
        /// What is wrong with it.
        problem: String,
    },
    /// A download failed.
    #[error("{address}: {problem}\nhint: {hint}")]
    Download {
        /// The address of the file, or the setting that is wrong.
        address: String,
        /// What happened.
        problem: String,
        /// What to do.
        hint: String,
    },
    /// The computation failed.
    #[error("{model}: {problem}")]
    Compute {
        /// The model.
        model: String,
        /// What happened.
        problem: String,
    },
}

impl LocalError {
    pub(crate) fn from_io(file: impl Into<PathBuf>, doing: &'static str, source: std::io::Error) -> Self {
        Self::Io { file: file.into(), doing, source: Arc::new(source) }
    }

    pub(crate) fn download_failed(
        address: impl Into<String>,
        problem: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self::Download { address: address.into(), problem: problem.into(), hint: hint.into() }
    }

    /// An error of candle while `model` computed.
    pub(crate) fn compute_failed(model: &str, error: &candle_core::Error) -> Self {
        // candle's errors may contain a backtrace, so only the first line is kept.
        let problem = error.to_string().lines().next().unwrap_or("the computation failed").to_owned();
        Self::Compute { model: model.to_owned(), problem }
    }

    pub(crate) fn bad_tensor(file: impl Into<PathBuf>, tensor: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Tensor { file: file.into(), tensor: tensor.into(), problem: problem.into() }
    }
}

//! What can go wrong, told once, and the exit codes of the program.

use std::{path::PathBuf, process::ExitCode};
use wayword_core::{ModelError, PlatformError};
use wayword_formats::FormatError;
use wayword_navigation::WalkError;
use wayword_synthesis::{observe::ObserveError, prompts::PromptError, style::StyleError};

/// How the program ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// Everything was done, and every check passed.
    Done = 0,
    /// The input was wrong: a flag, a file, a folder. Nothing was written.
    BadInput = 1,
    /// Done, but some items were rejected or failed their checks; each with its reason.
    WithLoss = 3,
    /// Another process works in the same run folder.
    Busy = 4,
    /// Stopped before the end: a budget was spent, a key refused, the user interrupted. The same command goes on.
    Stopped = 5,
}
// 2 is clap's own: the command line could not be read.

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        ExitCode::from(exit as u8)
    }
}

/// An error of a command.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A world's.
    #[error(transparent)]
    Platform(#[from] PlatformError),
    /// A dataset file's.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// A style's.
    #[error(transparent)]
    Style(#[from] StyleError),
    /// A prompt's.
    #[error(transparent)]
    Prompt(#[from] PromptError),
    /// A model gave nothing.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The ledger's.
    #[error(transparent)]
    Ledger(#[from] wayword_ledger::LedgerError),
    /// A model cannot be reached by its name.
    #[error(transparent)]
    Service(#[from] wayword_remote::ConfigError),
    /// A model cannot be had on this machine.
    #[cfg(feature = "local")]
    #[error(transparent)]
    Local(#[from] wayword_local::LocalError),
    /// An agent could not walk.
    #[error(transparent)]
    Walk(#[from] WalkError),
    /// A walk could not be seen.
    #[error(transparent)]
    Observe(#[from] ObserveError),
    /// A house could not be saved.
    #[error(transparent)]
    House(#[from] wayword_house::SaveError),
    /// The file system would not.
    #[error("{}: cannot {doing}: {source}", path.display())]
    Io {
        /// Which file or folder.
        path: PathBuf,
        /// What was tried.
        doing: &'static str,
        /// What the system said.
        source: std::io::Error,
    },
    /// What was asked for does not make sense.
    #[error("{problem}\nhint: {hint}")]
    Usage {
        /// What is wrong.
        problem: String,
        /// What to do.
        hint: String,
    },
    /// Another process has the run folder.
    #[error("{}: another wayword is at work in this run folder\nhint: wait for it, or give another --out", .0.display())]
    Busy(PathBuf),
    /// A process that cannot be looked for has the run folder, or had it when it was killed.
    #[error("{}: {by} is at work in this run folder, or was killed there; on {kind}, a network's file system, no lock tells which\nhint: wait for it, or give another --out; if it is gone, remove {} and give the same command", folder.display(), mark.display())]
    BusyElsewhere {
        /// The run folder.
        folder: PathBuf,
        /// Who, as far as it said.
        by: String,
        /// What the file system is called.
        kind: &'static str,
        /// The file that says so.
        mark: PathBuf,
    },
}

impl Error {
    /// A mistake of the user's, with the way out.
    pub fn usage(problem: impl Into<String>, hint: impl Into<String>) -> Self {
        Self::Usage { problem: problem.into(), hint: hint.into() }
    }

    /// What this build leaves out.
    pub fn not_built(problem: impl Into<String>) -> Self {
        Self::usage(problem, "build it with `cargo build --release --features full`")
    }

    /// A model's error, where it is one: what a model did not do now it may do later, or when more money is there.
    pub(crate) fn into_model_error(self) -> Result<ModelError, Self> {
        match self {
            Self::Model(error) | Self::Observe(ObserveError::Model(error)) => Ok(error),
            other => Err(other),
        }
    }

    /// A failed file operation.
    pub fn io(path: impl Into<PathBuf>, doing: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, doing, source }
    }

    /// The exit code that it ends the program with.
    #[must_use]
    pub fn exit_code(&self) -> Exit {
        match self {
            Self::Busy(_) | Self::BusyElsewhere { .. } => Exit::Busy,
            Self::Model(error) | Self::Observe(ObserveError::Model(error)) if error.ends_run() => Exit::Stopped,
            Self::Walk(error) if error.ends_run() => Exit::Stopped,
            _ => Exit::BadInput,
        }
    }
}

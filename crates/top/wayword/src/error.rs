//! What can go wrong, told once, and the exit codes of the program.

use std::{
    io::{self, ErrorKind},
    path::PathBuf,
    process::ExitCode,
};
use wayword_core::{Failure, ModelError, PlatformError, platform::is_lost_disk};
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
    /// Done, but some items failed, or some texts failed their checks; each with its reason.
    WithLoss = 3,
    /// Another process works in the same run folder.
    Busy = 4,
    /// Stopped before the end: a budget was spent or a key refused. The same command goes on.
    Stopped = 5,
    /// Interrupted by the user or by a scheduler (SIGINT, SIGTERM). The same command goes on.
    Interrupted = 6,
    /// The world, a service or the disk was lost. The same command goes on.
    Lost = 7,
}
// 2 is clap's own: the command line could not be read.

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        ExitCode::from(exit as u8)
    }
}

/// What to do about an error of the file system.
fn advice(error: &io::Error) -> &'static str {
    match error.kind() {
        ErrorKind::NotFound => "\nhint: check how the path is written, and that its folder is there",
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "\nhint: name another place, or see to it that you may use this one"
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "\nhint: make room, and give the same command again",
        ErrorKind::IsADirectory => "\nhint: name a file; this is a folder",
        _ => "",
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
    #[error("{}: cannot {doing}: {source}{}", path.display(), advice(source))]
    Io {
        /// Which file or folder.
        path: PathBuf,
        /// What was tried.
        doing: &'static str,
        /// What the system said.
        source: io::Error,
    },
    /// What was asked for does not make sense.
    #[error("{problem}\nhint: {hint}")]
    Usage {
        /// What is wrong.
        problem: String,
        /// What to do.
        hint: String,
    },
    /// A run is not continued in a world that has changed.
    #[error(
        "scene {scene}: its files are not those that the run was begun with ({} holds their hash)\nhint: put the old files back, or give another --out for a new run",
        record.display()
    )]
    OtherWorld {
        /// Which scene.
        scene: String,
        /// Where its hash is kept.
        record: PathBuf,
    },
    /// The user or a scheduler has interrupted the command.
    #[error("interrupted\nhint: give the same command again; what was finished is kept")]
    Interrupted,
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

    /// How one item's failure is dealt with; `None` for what concerns the whole run.
    pub(crate) fn failure(&self) -> Option<Failure> {
        match self {
            Self::Model(error) | Self::Observe(ObserveError::Model(error)) | Self::Walk(WalkError::Model(error)) => {
                (!error.ends_run()).then(|| error.failure())
            }
            Self::Platform(error)
            | Self::Observe(ObserveError::Platform(error))
            | Self::Walk(WalkError::Platform(error)) => Some(error.failure()),
            Self::Walk(_) | Self::Format(_) | Self::Style(_) | Self::Prompt(_) | Self::Usage { .. } => {
                Some(Failure::Broken)
            }
            _ => None,
        }
    }

    /// Whether the disk has no room left, or went away.
    fn is_of_the_disk(&self) -> bool {
        let is_full = |error: &io::Error| matches!(error.kind(), ErrorKind::StorageFull | ErrorKind::QuotaExceeded);
        matches!(self, Self::Io { source, .. } if is_full(source) || is_lost_disk(source))
    }

    /// A failed file operation.
    pub fn io(path: impl Into<PathBuf>, doing: &'static str) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, doing, source }
    }

    /// Whether a model's service lets nothing through any more.
    pub(crate) fn ends_sending(&self) -> bool {
        match self {
            Self::Model(error) | Self::Observe(ObserveError::Model(error)) | Self::Walk(WalkError::Model(error)) => {
                error.ends_run()
            }
            _ => false,
        }
    }

    /// The exit code that it ends the program with.
    #[must_use]
    pub fn exit_code(&self) -> Exit {
        match self {
            Self::Busy(_) | Self::BusyElsewhere { .. } => Exit::Busy,
            Self::Interrupted => Exit::Interrupted,
            error if error.is_of_the_disk() => Exit::Lost,
            error => match error.failure() {
                Some(Failure::Lost) => Exit::Lost,
                None if error.ends_sending() => Exit::Stopped,
                _ => Exit::BadInput,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Error as IoError;

    #[test]
    fn a_full_disk_is_a_loss_and_a_refused_file_is_wrong_input() {
        let error = |kind| Error::io("walks.jsonl", "write")(IoError::from(kind)).exit_code();
        assert_eq!(error(ErrorKind::StorageFull), Exit::Lost);
        assert_eq!(error(ErrorKind::PermissionDenied), Exit::BadInput);
    }
}

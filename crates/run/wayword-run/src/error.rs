//! The errors of the program, and its exit codes.

use std::{
    error::Error,
    io::{self, ErrorKind},
    path::PathBuf,
    sync::Arc,
};
use wayword_core::{FailureKind, ModelError, PlatformError, platform::is_lost_disk};
use wayword_formats::{FormatError, disk_advice};
#[cfg(feature = "experiments")]
use wayword_navigation::WalkError;
use wayword_queue::QueueError;
use wayword_synthesis::{observe::ObserveError, prompts::PromptError, style::StyleError};

/// How the program ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// Everything was done, and no check failed.
    Done = 0,
    /// The input is wrong: a flag, a file, a folder. No result was written.
    BadInput = 1,
    /// Done, but some items failed, or some texts failed their checks. The reasons are listed.
    WithLoss = 3,
    /// Another process is writing to the same run folder.
    Busy = 4,
    /// Stopped early: a budget is spent or a key was refused. The same command continues.
    Stopped = 5,
    /// Interrupted by the user or by a scheduler (SIGINT, SIGTERM). The same command continues.
    Interrupted = 6,
    /// The simulator, a service or the disk failed. The same command continues.
    Lost = 7,
}
// clap itself exits with 2 when the command line is wrong.

/// The hint that is printed with an error of the file system.
fn io_advice(error: &io::Error) -> String {
    if let Some(advice) = disk_advice(error) {
        return format!("\nhint: {advice}");
    }
    let hint = match error.kind() {
        ErrorKind::NotFound => "\nhint: check the spelling of the path, and that its folder exists",
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            "\nhint: give another path, or change its permissions"
        }
        ErrorKind::IsADirectory => "\nhint: give a file; this is a folder",
        ErrorKind::NotADirectory => {
            "\nhint: give the name of a folder; a file has this name, or the name of a folder above it"
        }
        _ => "\nhint: check the file and its disk, and give the same command again",
    };
    hint.to_owned()
}

/// Whether an error comes from a disk that is full, or from a file beyond a limit: no room is left for it.
fn has_no_room(error: &(dyn Error + 'static)) -> bool {
    let of_system = |error: &io::Error| disk_advice(error).is_some();
    let shared = error.downcast_ref::<Arc<io::Error>>().map(AsRef::as_ref);
    error.downcast_ref::<io::Error>().or(shared).is_some_and(of_system) || error.source().is_some_and(has_no_room)
}

/// An error of a command.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// Of a platform.
    #[error(transparent)]
    Platform(#[from] PlatformError),
    /// Of a dataset file.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// Of a style.
    #[error(transparent)]
    Style(#[from] StyleError),
    /// Of a prompt.
    #[error(transparent)]
    Prompt(#[from] PromptError),
    /// A model gave no answer.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Of the ledger.
    #[error(transparent)]
    Ledger(#[from] wayword_ledger::LedgerError),
    /// Of a run that many workers make.
    #[error(transparent)]
    Queue(#[from] wayword_queue::QueueError),
    /// Of the text that starts workers.
    #[error(transparent)]
    Launch(#[from] wayword_queue::launch::LaunchError),
    /// Of a database.
    #[cfg(feature = "queue")]
    #[error(transparent)]
    Database(#[from] wayword_database::DatabaseError),
    /// A model cannot be reached by its name.
    #[error(transparent)]
    Service(#[from] wayword_remote::ConfigError),
    /// A model in process cannot be loaded.
    #[cfg(feature = "local")]
    #[error(transparent)]
    Local(#[from] wayword_local::LocalError),
    /// An agent could not walk.
    #[cfg(feature = "experiments")]
    #[error(transparent)]
    Walk(#[from] WalkError),
    /// A path could not be observed.
    #[error(transparent)]
    Observe(#[from] ObserveError),
    /// Of a study.
    #[cfg(feature = "study")]
    #[error(transparent)]
    Study(#[from] wayword_study::StudyError),
    /// A house could not be saved.
    #[error(transparent)]
    House(#[from] wayword_house::SaveError),
    /// A file operation failed.
    #[error("{}: cannot {doing}: {source}{}", path.display(), io_advice(source))]
    Io {
        /// Which file or folder.
        path: PathBuf,
        /// What the program tried to do, as a verb.
        doing: &'static str,
        /// The error of the system.
        source: io::Error,
    },
    /// The user asked for something that cannot be done.
    #[error("{problem}\nhint: {hint}")]
    Usage {
        /// The problem.
        problem: String,
        /// The hint.
        hint: String,
    },
    /// A run is not continued with scene files that have changed.
    #[error(
        "scene {scene}: its files have changed since the run began ({} holds their old hash)\nhint: put the old files back, or give another --out for a new run",
        record.display()
    )]
    ChangedScene {
        /// Which scene.
        scene: String,
        /// The file that holds its hash.
        record: PathBuf,
    },
    /// The user or a scheduler has interrupted the command.
    #[error("interrupted\nhint: give the same command again to continue; finished items are kept")]
    Interrupted,
    /// Another process has the run folder.
    #[error("{}: another wayword process is writing to this run folder\nhint: wait for it, or give another --out", .0.display())]
    Busy(PathBuf),
    /// A process on another machine has the run folder, or had it when it was killed.
    #[error("{}: {by} may still be writing to this run folder, or was killed while writing; on a network file system ({kind}) a lock cannot show which\nhint: wait for it, or give another --out; if that process is gone, remove {} and give the same command again", folder.display(), mark.display())]
    BusyElsewhere {
        /// The run folder.
        folder: PathBuf,
        /// The process, as its file names it.
        by: String,
        /// Kind of the file system.
        kind: &'static str,
        /// The file that names the process.
        mark: PathBuf,
    },
}

impl CommandError {
    /// A mistake of the user, with a hint.
    pub fn usage(problem: impl Into<String>, hint: impl Into<String>) -> Self {
        Self::Usage { problem: problem.into(), hint: hint.into() }
    }

    /// A feature that this build lacks.
    pub fn not_built(problem: impl Into<String>) -> Self {
        Self::usage(problem, "build it with `cargo build --release --features full`")
    }

    /// How the failure of one item is handled; `None` if the error concerns the whole run.
    pub fn item_failure(&self) -> Option<FailureKind> {
        if let Some(error) = self.model_error() {
            return (!error.ends_run()).then(|| error.failure_kind());
        }
        if let Some(error) = self.platform_error() {
            return Some(error.failure_kind());
        }
        match self {
            #[cfg(feature = "experiments")]
            Self::Walk(_) => Some(FailureKind::Broken),
            Self::Format(_) | Self::Style(_) | Self::Prompt(_) | Self::Usage { .. } => Some(FailureKind::Broken),
            _ => None,
        }
    }

    /// Which part failed an item, as one word of a fixed list: `model`, `platform` or `other`.
    pub(crate) fn failed_part(&self) -> &'static str {
        match (self.model_error(), self.platform_error()) {
            (Some(_), _) => "model",
            (_, Some(_)) => "platform",
            _ => "other",
        }
    }

    /// Whether the disk is full or gone.
    fn is_disk_failure(&self) -> bool {
        if has_no_room(self) {
            return true;
        }
        match self {
            Self::Io { source, .. } => is_lost_disk(source),
            Self::Ledger(error) => error.is_lost(),
            Self::Queue(error) => error.is_lost(),
            #[cfg(feature = "queue")]
            Self::Database(error) => error.is_lost(),
            #[cfg(feature = "study")]
            Self::Study(error) => error.is_lost(),
            error => matches!(error.model_error(), Some(ModelError::Stopped { is_lost: true, .. })),
        }
    }

    /// A failed file operation.
    pub fn io(path: impl Into<PathBuf>, doing: &'static str) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, doing, source }
    }

    /// Whether the provider of a model accepts no more requests.
    pub(crate) fn ends_sending(&self) -> bool {
        self.model_error().is_some_and(ModelError::ends_run)
    }

    /// The error of a model, if it is one.
    pub(crate) fn model_error(&self) -> Option<&ModelError> {
        match self {
            Self::Model(error) | Self::Observe(ObserveError::Model(error)) => Some(error),
            #[cfg(feature = "experiments")]
            Self::Walk(WalkError::Model(error)) => Some(error),
            _ => None,
        }
    }

    /// The error of a platform, if it is one.
    pub(crate) fn platform_error(&self) -> Option<&PlatformError> {
        match self {
            Self::Platform(error) | Self::Observe(ObserveError::Platform(error)) => Some(error),
            #[cfg(feature = "experiments")]
            Self::Walk(WalkError::Platform(error)) => Some(error),
            _ => None,
        }
    }

    /// The exit code of the program.
    #[must_use]
    pub fn exit_code(&self) -> Exit {
        match self {
            Self::Busy(_) | Self::BusyElsewhere { .. } => Exit::Busy,
            // Another worker makes the same shard, or took it over from this worker.
            Self::Queue(QueueError::Busy { .. } | QueueError::TakenOver(_)) => Exit::Busy,
            Self::Interrupted => Exit::Interrupted,
            Self::Queue(error) if error.is_refused() => Exit::Stopped,
            error if error.is_disk_failure() => Exit::Lost,
            error => match error.item_failure() {
                Some(FailureKind::Lost) => Exit::Lost,
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
    fn exit_code_is_lost_for_a_full_disk_and_bad_input_for_a_refused_file() {
        let error = |kind| CommandError::io("walks.jsonl", "write")(IoError::from(kind)).exit_code();
        for full in [ErrorKind::StorageFull, ErrorKind::QuotaExceeded, ErrorKind::FileTooLarge] {
            assert_eq!(error(full), Exit::Lost, "{full}");
            let of_format = FormatError::Io { file: "texts.json".into(), doing: "write", source: IoError::from(full) };
            assert_eq!(CommandError::from(of_format).exit_code(), Exit::Lost, "{full}");
            let of_house = wayword_house::SaveError::File { file: "house.glb".into(), source: IoError::from(full) };
            assert_eq!(CommandError::from(of_house).exit_code(), Exit::Lost, "{full}");
        }
        assert_eq!(error(ErrorKind::PermissionDenied), Exit::BadInput);
        let stopped = |is_lost| {
            CommandError::from(ModelError::Stopped { reason: "no more".into(), hint: "wait".into(), is_lost })
                .exit_code()
        };
        assert_eq!([stopped(true), stopped(false)], [Exit::Lost, Exit::Stopped]);
    }
}

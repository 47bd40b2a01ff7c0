//! Errors of a run that many workers make.

use std::{io, path::PathBuf};

/// A plan, a chunk or a queue cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum QueueError {
    /// A file operation failed.
    #[error("{}: cannot {doing}: {source}\nhint: check that the folder is there and can be written, and that its disk has room", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The operation.
        doing: &'static str,
        /// The error of the system.
        source: io::Error,
    },
    /// A file has invalid content.
    #[error("{}: {problem}\nhint: it was changed by hand or by another version: use another folder", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// The problem.
        problem: String,
    },
    /// There is no plan.
    #[error("{}: there is no plan\nhint: make it with `wayword generate ... --out DIR --plan`; a worker (--shard, --queue) makes it too", .0.display())]
    NoPlan(PathBuf),
    /// A part of a run cannot be read as typed.
    #[error("--shard {typed}: {problem}\nhint: write K/N, as in --shard 3/64; K goes from 0 to N-1")]
    Part {
        /// The text of the flag.
        typed: String,
        /// The problem.
        problem: &'static str,
    },
    /// Another worker has the shard, or another cut of the run is at work.
    #[error("{}: {who} is at work, and gave a sign of life {seconds} seconds ago\nhint: wait for it; if it is gone, the same command works {fresh} seconds after its last sign, and on its own machine at once", path.display())]
    Busy {
        /// The heartbeat's file.
        path: PathBuf,
        /// The other worker, for people.
        who: String,
        /// Age of its last heartbeat, seconds.
        seconds: u64,
        /// How long a heartbeat counts, seconds.
        fresh: u64,
    },
    /// This worker's heartbeat was taken over: it was suspended for too long.
    #[error("{}: another worker took over, because this one gave no sign of life for too long\nhint: nothing is lost: the other worker goes on", .0.display())]
    TakenOver(PathBuf),
    /// The database cannot be used.
    #[cfg(feature = "postgres")]
    #[error(transparent)]
    Database(#[from] wayword_database::DatabaseError),
    /// The object store cannot be used.
    #[cfg(feature = "cloud")]
    #[error(transparent)]
    Cloud(#[from] crate::cloud::CloudError),
}

impl QueueError {
    /// Makes an error of a file operation out of the system's error, for `map_err`.
    pub(crate) fn for_file(path: impl Into<PathBuf>, doing: &'static str) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { path, doing, source }
    }

    /// Whether a store refuses this worker's key.
    #[must_use]
    pub fn is_refused(&self) -> bool {
        match self {
            #[cfg(feature = "cloud")]
            Self::Cloud(error) => error.is_refused(),
            _ => false,
        }
    }

    /// Whether the disk or the database failed, so that the same command may work later.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        match self {
            Self::Io { source, .. } => {
                matches!(
                    source.kind(),
                    io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded | io::ErrorKind::StaleNetworkFileHandle
                )
            }
            #[cfg(feature = "postgres")]
            Self::Database(error) => error.is_lost(),
            #[cfg(feature = "cloud")]
            Self::Cloud(error) => error.is_lost(),
            _ => false,
        }
    }
}

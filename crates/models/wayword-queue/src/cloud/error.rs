//! Errors of object stores.

use std::{io, path::PathBuf};

/// An object store cannot be used. The messages contain no text of a server and no part of a credential, because a
/// server's answer can repeat signatures and keys.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CloudError {
    /// The address cannot be used. It is not repeated, because it may hold a password.
    #[error("the address of the object store {problem}\nhint: {hint}")]
    Address {
        /// The problem.
        problem: &'static str,
        /// How the user can fix it.
        hint: &'static str,
    },
    /// The name of an object cannot be used.
    #[error(
        "object {name:?}: the name {problem}\nhint: a name has parts between `/`, without `.`, `..`, `\\` and control characters"
    )]
    Name {
        /// The name, cut.
        name: String,
        /// The problem.
        problem: &'static str,
    },
    /// There are no credentials, or the store does not know them.
    #[error(
        "{at}: no valid credentials ({answer})\nhint: set the variables of the provider, such as AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY, AZURE_STORAGE_ACCOUNT_NAME and AZURE_STORAGE_ACCOUNT_KEY, or GOOGLE_APPLICATION_CREDENTIALS; they may have expired"
    )]
    Credentials {
        /// Address of the object.
        at: String,
        /// The answer's code, or the cause.
        answer: String,
    },
    /// The bucket or container does not exist.
    #[error(
        "{bucket}: there is no such bucket or container\nhint: make it first, and check the region and the endpoint (AWS_REGION, AWS_ENDPOINT_URL)"
    )]
    NoBucket {
        /// The address of the bucket.
        bucket: String,
    },
    /// The credentials are known, and do not allow this.
    #[error(
        "{at}: no permission to {doing} ({answer})\nhint: let the credentials list, read and write below this prefix"
    )]
    Permission {
        /// Address of the object.
        at: String,
        /// The operation.
        doing: &'static str,
        /// The answer's code.
        answer: String,
    },
    /// The store did not answer, or not in time. The same may work later.
    #[error(
        "{at}: cannot {doing}: {problem}\nhint: check the network and the endpoint, and run the same command again: what is done stays done"
    )]
    Network {
        /// Address of the object.
        at: String,
        /// The operation.
        doing: &'static str,
        /// The cause.
        problem: String,
    },
    /// The store has no put-if-absent.
    #[error(
        "{bucket}: the store cannot make an object only where there is none ({problem})\nhint: use a store with conditional writes (If-None-Match), or a queue in PostgreSQL for the claims"
    )]
    NoPutNew {
        /// The address of the bucket.
        bucket: String,
        /// The evidence.
        problem: &'static str,
    },
    /// There is more than the caller allows.
    #[error("{at}: {bytes} bytes, and {most} are allowed\nhint: allow more, or name a smaller part")]
    TooLarge {
        /// Which object or prefix.
        at: String,
        /// How many bytes there are, at least.
        bytes: u64,
        /// How many are allowed.
        most: u64,
    },
    /// There are too many objects.
    #[error("{at}: more than {most} objects\nhint: name a smaller part")]
    TooMany {
        /// Which prefix.
        at: String,
        /// How many are allowed.
        most: usize,
    },
    /// An object changed while it was read.
    #[error("{at}: it changed while it was fetched\nhint: run the same command again when nobody writes there")]
    Changed {
        /// Address of the object.
        at: String,
    },
    /// A file or folder of this machine cannot be used.
    #[error("{}: cannot {doing}: {source}\nhint: check that it is there and can be read and written, and that its disk has room", path.display())]
    Local {
        /// Which file or folder.
        path: PathBuf,
        /// The operation.
        doing: &'static str,
        /// The error of the system.
        source: io::Error,
    },
    /// The store refused for another reason.
    #[error("{at}: cannot {doing}: {answer}\nhint: {hint}")]
    Refused {
        /// Address of the object.
        at: String,
        /// The operation.
        doing: &'static str,
        /// The answer's code.
        answer: String,
        /// How the user can fix it.
        hint: &'static str,
    },
    /// A call of this module, all of which block, was made inside an asynchronous task.
    #[error("object stores cannot be used inside an asynchronous task\nhint: call from a thread of its own")]
    InsideAsync,
}

impl CloudError {
    /// Makes an error of a file of this machine out of the system's error, for `map_err`.
    pub(super) fn for_local_file(path: impl Into<PathBuf>, doing: &'static str) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| Self::Local { path, doing, source }
    }

    /// Whether the network, the store or a full disk is the cause, so that the same command may work later.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        match self {
            Self::Network { .. } | Self::Changed { .. } => true,
            Self::Local { source, .. } => {
                matches!(source.kind(), io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded)
            }
            _ => false,
        }
    }

    /// Whether the credentials are missing, unknown or not allowed to do this.
    #[must_use]
    pub fn is_refused(&self) -> bool {
        matches!(self, Self::Credentials { .. } | Self::Permission { .. })
    }
}

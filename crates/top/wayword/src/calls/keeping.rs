//! Where the calls of a command are kept.

use super::ledger_path;
use crate::{error::Error, settings::Service};
use std::path::PathBuf;
use wayword_ledger::Ledger;

/// Where calls are kept.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Keeping {
    /// In the ledger of this machine, which all runs share.
    #[default]
    Machine,
    /// In a recording in each chunk: for workers that share a folder alone. These are the recordings that a shard has so far; what
    /// they cost counts.
    Chunks(Vec<PathBuf>),
    /// In a database that all workers share, with how long a sign of life of a worker counts.
    #[cfg(feature = "queue")]
    Database(wayword_database::Database, std::time::Duration),
}

impl Keeping {
    /// Refuses a place where calls cannot be kept. Opens and makes nothing.
    pub(super) fn check(&self, service: &Service) -> Result<(), Error> {
        match self {
            Self::Machine => Ok(Ledger::check_place(&ledger_path(service)?)?),
            Self::Chunks(_) => Ok(()),
            #[cfg(feature = "queue")]
            Self::Database(..) => Ok(()),
        }
    }

    /// Opens the ledger.
    pub(super) fn open(&self, service: &Service) -> Result<Ledger, Error> {
        Ok(match self {
            Self::Machine => Ledger::open(&ledger_path(service)?)?,
            Self::Chunks(recordings) => Ledger::in_chunks(recordings)?,
            #[cfg(feature = "queue")]
            Self::Database(database, lease) => Ledger::postgres_with_lease(database, *lease)?,
        })
    }
}

//! The choice of the ledger that keeps the calls of a command.

use super::ledger_path;
use crate::{error::CommandError, settings::Service};
use std::path::PathBuf;
use wayword_ledger::Ledger;

/// Where calls are kept.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum CallKeeping {
    /// In the ledger of this machine, which all runs share.
    #[default]
    Machine,
    /// In a recording in each chunk, for workers that share only a folder. The list has the recordings that a shard has so far;
    /// their cost counts towards its budget.
    Chunks(Vec<PathBuf>),
    /// In a database that all workers share. The duration is how long a worker's sign of life counts.
    #[cfg(feature = "queue")]
    Database(wayword_database::PostgresDatabase, std::time::Duration),
}

impl CallKeeping {
    /// Refuses a place where calls cannot be kept. Does not open or make a file.
    pub(super) fn check_store(&self, service: &Service) -> Result<(), CommandError> {
        match self {
            Self::Machine => Ok(Ledger::check_place(&ledger_path(service)?)?),
            Self::Chunks(_) => Ok(()),
            #[cfg(feature = "queue")]
            Self::Database(..) => Ok(()),
        }
    }

    /// Opens the ledger.
    pub(super) fn open_ledger(&self, service: &Service) -> Result<Ledger, CommandError> {
        Ok(match self {
            Self::Machine => Ledger::open(&ledger_path(service)?)?,
            Self::Chunks(recordings) => Ledger::in_chunks(recordings)?,
            #[cfg(feature = "queue")]
            Self::Database(database, lease) => Ledger::postgres_with_lease(database, *lease)?,
        })
    }
}

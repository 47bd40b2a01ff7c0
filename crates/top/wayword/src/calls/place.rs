//! Where the ledger lies.

use crate::{error::Error, settings::Service};
use etcetera::BaseStrategy;
use std::path::PathBuf;

/// The ledger that flags or file name, else the one in the user's data folder: one for all runs, so that what one run has
/// asked the next does not pay for.
///
/// # Errors
/// When the user has no home folder.
pub fn ledger_path(service: &Service) -> Result<PathBuf, Error> {
    if let Some(path) = &service.ledger {
        return Ok(path.clone());
    }
    let strategy = etcetera::choose_base_strategy().map_err(|_| {
        Error::usage("there is no home folder to keep the ledger in", "name a file, as in --ledger calls.db")
    })?;
    Ok(strategy.data_dir().join("wayword").join("ledger.db"))
}

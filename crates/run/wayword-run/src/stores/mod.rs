//! Object stores (addresses such as `s3://bucket/big`) in place of folders: data is fetched before it is read, and the workers
//! of a run send each finished chunk.

#[cfg(not(feature = "cloud"))]
mod absent;
#[cfg(feature = "cloud")]
mod data;
mod run_place;

#[cfg(not(feature = "cloud"))]
use absent::{CloudRun, fetch_data};
#[cfg(feature = "cloud")]
use data::fetch_data;
pub use run_place::RunPlace;
use std::{borrow::Cow, path::Path};
#[cfg(feature = "cloud")]
use wayword_queue::cloud::CloudRun;

use crate::error::CommandError;

/// The address of an object store, if the path is one and not a folder.
#[must_use]
pub fn store_address(path: &Path) -> Option<&str> {
    path.to_str().filter(|text| text.contains("://"))
}

/// The folder or file of the data on this machine; data in an object store is fetched first.
///
/// # Errors
/// When it cannot be fetched, or this build cannot reach object stores.
pub fn local_data(data: &Path) -> Result<Cow<'_, Path>, CommandError> {
    match store_address(data) {
        None => Ok(Cow::Borrowed(data)),
        Some(address) => fetch_data(address).map(Cow::Owned),
    }
}

/// Refuses an address of an object store in place of a folder.
///
/// # Errors
/// When it is one.
pub fn refuse_address(folder: &Path, problem: &str, hint: &str) -> Result<(), CommandError> {
    match store_address(folder) {
        None => Ok(()),
        Some(address) => Err(CommandError::usage(format!("{address}: {problem}"), hint)),
    }
}

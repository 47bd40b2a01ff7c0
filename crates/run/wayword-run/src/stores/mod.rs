//! Object stores (addresses such as `s3://bucket/big`) in place of folders: data is fetched before it is read, and the workers
//! of a run send each finished chunk.

#[cfg(not(feature = "cloud"))]
mod absent;
#[cfg(feature = "cloud")]
mod data;
mod run_place;

#[cfg(not(feature = "cloud"))]
use absent::{StoredRun, fetched};
#[cfg(feature = "cloud")]
use data::fetched;
pub use run_place::RunPlace;
use std::{borrow::Cow, path::Path};
#[cfg(feature = "cloud")]
use wayword_queue::cloud::StoredRun;

use crate::error::Error;

/// The address of an object store, if the path is one and not a folder.
fn address(path: &Path) -> Option<&str> {
    path.to_str().filter(|text| text.contains("://"))
}

/// The folder or file of the data on this machine; data in an object store is fetched first.
///
/// # Errors
/// When it cannot be fetched, or this build cannot reach object stores.
pub fn local(data: &Path) -> Result<Cow<'_, Path>, Error> {
    match address(data) {
        None => Ok(Cow::Borrowed(data)),
        Some(address) => fetched(address).map(Cow::Owned),
    }
}

/// Refuses an address of an object store in place of a folder.
///
/// # Errors
/// When it is one.
pub fn refuse_address(folder: &Path, problem: &str, hint: &str) -> Result<(), Error> {
    match address(folder) {
        None => Ok(()),
        Some(address) => Err(Error::usage(format!("{address}: {problem}"), hint)),
    }
}

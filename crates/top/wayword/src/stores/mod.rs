//! Folders in object stores: data that is fetched before it is read, and runs whose workers send what they made.

#[cfg(not(feature = "cloud"))]
mod absent;
#[cfg(feature = "cloud")]
mod data;
mod run_place;

#[cfg(not(feature = "cloud"))]
use absent::{StoredRun, fetched};
#[cfg(feature = "cloud")]
use data::fetched;
pub(crate) use run_place::RunPlace;
use std::{borrow::Cow, path::Path};
#[cfg(feature = "cloud")]
use wayword_queue::cloud::StoredRun;

use crate::error::Error;

/// The address of an object store that stands in place of a folder.
fn address(path: &Path) -> Option<&str> {
    path.to_str().filter(|text| text.contains("://"))
}

/// Where data lies on this machine. What lies in an object store is fetched.
///
/// # Errors
/// When it cannot be fetched, or this build cannot reach object stores.
pub(crate) fn local(data: &Path) -> Result<Cow<'_, Path>, Error> {
    match address(data) {
        None => Ok(Cow::Borrowed(data)),
        Some(address) => fetched(address).map(Cow::Owned),
    }
}

/// Refuses an address of an object store in place of a folder.
///
/// # Errors
/// When it is one.
pub(crate) fn refuse_address(folder: &Path, problem: &str, hint: &str) -> Result<(), Error> {
    match address(folder) {
        None => Ok(()),
        Some(address) => Err(Error::usage(format!("{address}: {problem}"), hint)),
    }
}

//! Fetches the data of a platform from an object store into a cache folder of this machine, once.

use crate::{error::CommandError, output};
use etcetera::BaseStrategy;
use sha2::{Digest, Sha256};
use std::{
    cell::Cell,
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
    time::{Duration, Instant},
};
use wayword_core::hex_text;
use wayword_queue::{QueueError, cloud::CloudBucket};

/// Largest data of one address that is fetched, bytes (4 TiB). More is an error.
const MAX_FETCHED_BYTES: u64 = 1 << 42;
/// Time between two messages about the progress.
const PROGRESS_INTERVAL: Duration = Duration::from_secs(10);

/// The local folder with the data of an address. Files that have changed in the store are fetched again, at most once per
/// process.
pub(super) fn fetch_data(address: &str) -> Result<PathBuf, CommandError> {
    static FETCHED_FOLDERS: Mutex<BTreeMap<String, PathBuf>> = Mutex::new(BTreeMap::new());
    let mut fetched_folders = FETCHED_FOLDERS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(folder) = fetched_folders.get(address) {
        return Ok(folder.clone());
    }
    let no_data_error = || {
        CommandError::usage(
            format!("{address}: there is no data there"),
            "give the prefix under which the files of the data's folder lie",
        )
    };
    // Opening a bucket that is a folder would make the folder.
    if address.strip_prefix("file://").is_some_and(|folder| !Path::new(folder).exists()) {
        return Err(no_data_error());
    }
    let folder = cache_folder_for(address)?;
    let bucket = CloudBucket::open(address).map_err(QueueError::from)?;
    let last_message = Cell::new(None::<Instant>);
    let progress = |done: u64, all: u64| {
        if done < all && last_message.get().is_none_or(|at| at.elapsed() > PROGRESS_INTERVAL) {
            last_message.set(Some(Instant::now()));
            output::print_foreign_line(&format!("fetching {address}: {} of {} MB", done >> 20, all >> 20));
        }
    };
    let fetched = bucket.fetch_folder("", &folder, MAX_FETCHED_BYTES, &progress).map_err(QueueError::from)?;
    if fetched.files + fetched.kept == 0 {
        return Err(no_data_error());
    }
    fetched_folders.insert(address.to_owned(), folder.clone());
    Ok(folder)
}

/// The folder for the data of an address, in the user's cache and named by a hash of the address.
fn cache_folder_for(address: &str) -> Result<PathBuf, CommandError> {
    let strategy = etcetera::choose_base_strategy().map_err(|_| {
        CommandError::usage("there is no home folder to fetch the data to", "set HOME or XDG_CACHE_HOME")
    })?;
    let hash = Sha256::digest(address.trim_end_matches('/').as_bytes());
    Ok(strategy.cache_dir().join("wayword").join("data").join(hex_text(&hash[..16])))
}

//! A lock that allows one program at a time to fetch into a folder.

use super::{CloudError, FETCH_INDEX_FILE};
use std::{
    fs::File,
    path::Path,
    time::{SystemTime, UNIX_EPOCH},
};

/// The ending of an unfinished file's name.
pub(super) const UNFINISHED_SUFFIX: &str = ".wayword-part";

/// A lock of a folder, until it is dropped or the program ends.
///
/// `None` where the file system has no locks.
pub(super) struct FetchLock(Option<File>);

impl FetchLock {
    /// Waits until no other program fetches into the folder. Some network file systems have no locks. There the fetch goes
    /// on, and its unfinished files have unique names ([`FetchLock::unfinished_suffix`]).
    pub(super) fn wait_for(folder: &Path) -> Result<Self, CloudError> {
        let path = folder.join(format!("{FETCH_INDEX_FILE}.lock"));
        let file = File::options().create(true).truncate(false).write(true).open(&path);
        let file = file.map_err(CloudError::for_local_file(&path, "write"))?;
        Ok(Self(file.lock().is_ok().then_some(file)))
    }

    /// The ending of unfinished files' names. Under the lock it is always the same, so that the next fetch replaces the
    /// files that a killed one has left.
    pub(super) fn unfinished_suffix(&self) -> String {
        if self.0.is_some() {
            return UNFINISHED_SUFFIX.to_owned();
        }
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos();
        format!(".{:x}-{since:x}{UNFINISHED_SUFFIX}", std::process::id())
    }
}

//! Lets one program at a time fetch into a folder.

use super::{CloudError, INDEX};
use std::{
    fs::File,
    path::Path,
    time::{SystemTime, UNIX_EPOCH},
};

/// What the name of an unfinished file ends in.
pub(super) const UNFINISHED: &str = ".wayword-part";

/// A lock of a folder, until it is dropped or the program ends.
pub(super) struct Lock(Option<File>);

impl Lock {
    /// Waits until no other program fetches into the folder. Not all network file systems have locks: without one the
    /// fetch goes on, under names of its own.
    pub(super) fn wait(folder: &Path) -> Result<Self, CloudError> {
        let path = folder.join(format!("{INDEX}.lock"));
        let file = File::options().create(true).truncate(false).write(true).open(&path);
        let file = file.map_err(CloudError::local(&path, "write"))?;
        Ok(Self(file.lock().is_ok().then_some(file)))
    }

    /// What the names of unfinished files end in. Under the lock it is always the same, so that the next fetch
    /// replaces what a killed one has left.
    pub(super) fn ending(&self) -> String {
        if self.0.is_some() {
            return UNFINISHED.to_owned();
        }
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_nanos();
        format!(".{:x}-{since:x}{UNFINISHED}", std::process::id())
    }
}

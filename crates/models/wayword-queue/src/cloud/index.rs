//! The index of a fetched folder: the version of each file when it was fetched, so that unchanged files are not fetched
//! again.

use super::{CloudError, Entry, INDEX};
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeMap,
    fs::{self, File},
    io::{ErrorKind, Read, Write},
    path::Path,
};

/// The most bytes of an index that are read: about a million names.
const LARGEST: u64 = 512 << 20;

#[derive(Serialize, Deserialize, Default)]
pub(super) struct Index {
    /// The address in the store. Files from another address do not count.
    from: String,
    /// The version of each file when it was fetched.
    files: BTreeMap<String, Known>,
}

#[derive(Serialize, Deserialize, PartialEq)]
struct Known {
    bytes: u64,
    version: String,
}

impl Index {
    /// The index of a folder. If the file is missing, broken or from another address, the index is empty, and everything is
    /// fetched.
    pub(super) fn read(folder: &Path, from: &str) -> Result<Self, CloudError> {
        let path = folder.join(INDEX);
        let empty = || Self { from: from.to_owned(), files: BTreeMap::new() };
        let file = match File::open(&path) {
            Ok(file) => file,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(empty()),
            Err(error) => return Err(CloudError::local(&path, "read")(error)),
        };
        let mut text = Vec::new();
        file.take(LARGEST).read_to_end(&mut text).map_err(CloudError::local(&path, "read"))?;
        Ok(serde_json::from_slice::<Self>(&text).ok().filter(|index| index.from == from).unwrap_or_else(empty))
    }

    /// Whether the file is there in this version. Its length is compared, its content is not read.
    pub(super) fn has(&self, folder: &Path, entry: &Entry) -> bool {
        let Some(version) = &entry.version else { return false };
        let known = Known { bytes: entry.bytes, version: version.clone() };
        self.files.get(&entry.name) == Some(&known)
            && fs::symlink_metadata(folder.join(&entry.name))
                .is_ok_and(|about| about.is_file() && about.len() == entry.bytes)
    }

    pub(super) fn add(&mut self, entry: &Entry) {
        if let Some(version) = &entry.version {
            self.files.insert(entry.name.clone(), Known { bytes: entry.bytes, version: version.clone() });
        }
    }

    pub(super) fn write(&self, folder: &Path) -> Result<(), CloudError> {
        let path = folder.join(INDEX);
        let part = folder.join(format!("{INDEX}.{}.part", std::process::id()));
        let written = File::create(&part).and_then(|mut file| {
            file.write_all(&serde_json::to_vec(self)?)?;
            file.sync_all()?;
            fs::rename(&part, &path)
        });
        written.map_err(CloudError::local(&path, "write"))
    }
}

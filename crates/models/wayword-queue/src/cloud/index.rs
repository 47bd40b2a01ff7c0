//! The index of a fetched folder: the version of each file when it was fetched, so that unchanged files are not fetched
//! again.

use super::{CloudError, StoredObject};
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeMap,
    fs::{self, File},
    io::{ErrorKind, Read, Write},
    path::Path,
};

/// The file in which a folder's fetched files are listed.
pub const FETCH_INDEX_FILE: &str = ".wayword-fetched.json";

/// The most bytes of an index that are read, enough for about a million names. A larger index counts as broken.
const MAX_INDEX_BYTES: u64 = 512 << 20;

/// The index of a fetched folder, as its file stores it.
#[derive(Serialize, Deserialize, Default)]
pub(super) struct FetchIndex {
    /// The address in the store. Files from another address do not count.
    from: String,
    /// The version of each file when it was fetched.
    files: BTreeMap<String, IndexedFile>,
}

/// The size and the version of a fetched file.
#[derive(Serialize, Deserialize, PartialEq)]
struct IndexedFile {
    bytes: u64,
    version: String,
}

impl FetchIndex {
    /// The index of a folder. If the file is missing, broken or from another address, the index is empty, and everything is
    /// fetched.
    pub(super) fn read_index(folder: &Path, from: &str) -> Result<Self, CloudError> {
        let path = folder.join(FETCH_INDEX_FILE);
        let empty = || Self { from: from.to_owned(), files: BTreeMap::new() };
        let file = match File::open(&path) {
            Ok(file) => file,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(empty()),
            Err(error) => return Err(CloudError::for_local_file(&path, "read")(error)),
        };
        let mut text = Vec::new();
        file.take(MAX_INDEX_BYTES).read_to_end(&mut text).map_err(CloudError::for_local_file(&path, "read"))?;
        Ok(serde_json::from_slice::<Self>(&text).ok().filter(|index| index.from == from).unwrap_or_else(empty))
    }

    /// Whether the file is there in this version. Its length is compared, its content is not read.
    pub(super) fn has_object(&self, folder: &Path, entry: &StoredObject) -> bool {
        let Some(version) = &entry.version else { return false };
        let known = IndexedFile { bytes: entry.bytes, version: version.clone() };
        self.files.get(&entry.name) == Some(&known)
            && fs::symlink_metadata(folder.join(&entry.name))
                .is_ok_and(|about| about.is_file() && about.len() == entry.bytes)
    }

    /// Adds a fetched file. A file without a version is left out, so that it is fetched again.
    pub(super) fn add_object(&mut self, entry: &StoredObject) {
        if let Some(version) = &entry.version {
            self.files.insert(entry.name.clone(), IndexedFile { bytes: entry.bytes, version: version.clone() });
        }
    }

    /// Writes the index into its folder, whole or not at all.
    pub(super) fn write_index(&self, folder: &Path) -> Result<(), CloudError> {
        let path = folder.join(FETCH_INDEX_FILE);
        let part = folder.join(format!("{FETCH_INDEX_FILE}.{}.part", std::process::id()));
        let written = File::create(&part).and_then(|mut file| {
            file.write_all(&serde_json::to_vec(self)?)?;
            file.sync_all()?;
            fs::rename(&part, &path)
        });
        written.map_err(CloudError::for_local_file(&path, "write"))
    }
}

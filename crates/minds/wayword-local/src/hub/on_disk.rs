//! Files that are on this machine, or nowhere.

use super::needs::Files;
use crate::LocalError;
use std::path::{Path, PathBuf};

/// A folder, and what to do about a file that it lacks.
pub(super) struct OnDisk<'a> {
    folder: PathBuf,
    hint: &'a dyn Fn(&str) -> String,
}

impl<'a> OnDisk<'a> {
    pub(super) fn new(folder: PathBuf, hint: &'a dyn Fn(&str) -> String) -> Self {
        Self { folder, hint }
    }
}

impl OnDisk<'static> {
    /// A folder of the user's.
    pub(super) fn local(folder: &Path) -> Self {
        let hint = &|file: &str| format!("put the model's {file} there, or see whether the path is right");
        Self { folder: folder.to_owned(), hint }
    }
}

impl Files for OnDisk<'_> {
    fn folder(&self) -> PathBuf {
        self.folder.clone()
    }

    fn here(&self, file: &str) -> Option<PathBuf> {
        let path = self.folder.join(file);
        path.is_file().then_some(path)
    }

    fn get(&mut self, file: &str) -> Result<Option<PathBuf>, LocalError> {
        Ok(self.here(file))
    }

    fn missing(&self, file: &str, what: &'static str) -> LocalError {
        LocalError::Missing { file: self.folder.join(file), what, hint: (self.hint)(file) }
    }
}

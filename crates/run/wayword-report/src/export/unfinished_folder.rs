//! A folder that is written as a whole. Everything is made in a hidden folder inside it, and moved to its place at the end. What a
//! command that was killed left behind is recognised by the hidden folder, and made again.

use std::{
    fs,
    io::ErrorKind,
    path::{Path, PathBuf},
};
use wayword_run::{
    error::CommandError,
    run_folder::{FolderLock, file, lock_folder},
};

/// The hidden folder, until all is complete.
const UNFINISHED: &str = ".unfinished";

/// A folder with contents that are being made.
pub(super) struct UnfinishedFolder {
    folder: PathBuf,
    unfinished: PathBuf,
    /// Keeps other commands away from the folder.
    _held: FolderLock,
}

impl Drop for UnfinishedFolder {
    /// Removes what an export that failed has made. Else its hidden folder would mark all beside it as left by a killed one.
    fn drop(&mut self) {
        // The failure itself is what the user is told.
        let _ = fs::remove_dir_all(&self.unfinished);
    }
}

impl UnfinishedFolder {
    /// Begins a folder. What an earlier command left unfinished in it is removed.
    ///
    /// # Errors
    /// When it has files of its own, because they would be published with the dataset; when another command works in it; or when it
    /// cannot be written.
    pub(super) fn begin(folder: &Path) -> Result<Self, CommandError> {
        let unfinished = folder.join(UNFINISHED);
        // Before the hidden folder was made, this folder was empty. So whatever stands beside it is from the killed command.
        let is_killed_export = unfinished.is_dir();
        if !is_killed_export && list_entries(folder)?.next().is_some() {
            let problem =
                format!("{}: the folder has files, and all of a dataset's folder is published", folder.display());
            return Err(CommandError::usage(problem, "give a new folder, or empty this one"));
        }
        fs::create_dir_all(&unfinished).map_err(CommandError::io(&unfinished, "make the folder"))?;
        let held = lock_folder(&unfinished)?;
        let lock = unfinished.join(file::LOCK);
        let left = list_entries(folder)?.filter(|entry| *entry != unfinished);
        for entry in left.chain(list_entries(&unfinished)?.filter(|entry| *entry != lock)) {
            let removed = if entry.is_dir() { fs::remove_dir_all(&entry) } else { fs::remove_file(&entry) };
            removed.map_err(CommandError::io(&entry, "remove what a killed command left in"))?;
        }
        Ok(Self { folder: folder.to_owned(), unfinished, _held: held })
    }

    /// Where the files are made.
    pub(super) fn place(&self) -> &Path {
        &self.unfinished
    }

    /// Moves the files and folders of these names to their places.
    ///
    /// # Errors
    /// When one cannot be moved.
    pub(super) fn finish<'n>(self, names: impl IntoIterator<Item = &'n str>) -> Result<(), CommandError> {
        for name in names {
            let place = self.folder.join(name);
            fs::rename(self.unfinished.join(name), &place).map_err(CommandError::io(place, "write"))?;
        }
        fs::remove_dir_all(&self.unfinished).map_err(CommandError::io(&self.unfinished, "remove"))
    }
}

/// The entries of a folder; none if it does not exist.
fn list_entries(folder: &Path) -> Result<std::vec::IntoIter<PathBuf>, CommandError> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new().into_iter()),
        entries => entries.map_err(CommandError::io(folder, "look into"))?,
    };
    let paths = entries.map(|entry| Ok(entry.map_err(CommandError::io(folder, "look into"))?.path()));
    Ok(paths.collect::<Result<Vec<_>, CommandError>>()?.into_iter())
}

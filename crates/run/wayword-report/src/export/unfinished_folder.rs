//! A folder that is written as a whole. Everything is made in a hidden folder inside it, and moved to its place at the end. What a
//! command that was killed left behind is recognised by the hidden folder, and made again.

use std::{
    fs,
    io::ErrorKind,
    path::{Path, PathBuf},
};
use wayword_run::error::CommandError;

/// The hidden folder, until all is complete.
const UNFINISHED: &str = ".unfinished";

/// A folder with contents that are being made.
pub(super) struct UnfinishedFolder {
    folder: PathBuf,
    unfinished: PathBuf,
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
    /// When it has files of its own, because they would be published with the dataset, or it cannot be written.
    pub(super) fn begin(folder: &Path) -> Result<Self, CommandError> {
        let unfinished = folder.join(UNFINISHED);
        // Before the hidden folder was made, this folder was empty. So whatever stands beside it is from the killed command.
        let is_killed_export = unfinished.is_dir();
        match fs::read_dir(folder) {
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            Err(error) => return Err(CommandError::io(folder, "look into")(error)),
            Ok(entries) => {
                for entry in entries {
                    let entry = entry.map_err(CommandError::io(folder, "look into"))?.path();
                    if !is_killed_export {
                        let problem = format!(
                            "{}: the folder has files, and all of a dataset's folder is published",
                            folder.display()
                        );
                        return Err(CommandError::usage(problem, "give a new folder, or empty this one"));
                    }
                    if entry != unfinished {
                        let removed = if entry.is_dir() { fs::remove_dir_all(&entry) } else { fs::remove_file(&entry) };
                        removed.map_err(CommandError::io(&entry, "remove what a killed command left in"))?;
                    }
                }
            }
        }
        if is_killed_export {
            fs::remove_dir_all(&unfinished)
                .map_err(CommandError::io(&unfinished, "remove what a killed command left in"))?;
        }
        fs::create_dir_all(&unfinished).map_err(CommandError::io(&unfinished, "make the folder"))?;
        Ok(Self { folder: folder.to_owned(), unfinished })
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
        fs::remove_dir(&self.unfinished).map_err(CommandError::io(&self.unfinished, "remove"))
    }
}

//! Writes the pictures of a film as numbered PNG files in a folder.

use super::{super::picture, FilmWriter};
use std::{fs, path::PathBuf};
use wayword_core::Image;
use wayword_run::{error::CommandError, written_files::write_file};

/// The folder, and the files that have been written so far.
pub(super) struct FolderFilm {
    folder: PathBuf,
    files: Vec<PathBuf>,
}

impl FolderFilm {
    /// A folder for at most `most` pictures; it is made with the first of them.
    ///
    /// # Errors
    /// When it already contains other files, or a picture with a number above `most`: old and new pictures would be mixed.
    pub(super) fn new(folder: PathBuf, most: usize) -> Result<Self, CommandError> {
        if folder.exists() {
            for entry in fs::read_dir(&folder).map_err(CommandError::io(&folder, "read"))? {
                let name = entry.map_err(CommandError::io(&folder, "read"))?.file_name();
                let number = name.to_str().and_then(number_of);
                if number.is_none_or(|number| number > most) {
                    let problem =
                        format!("--out {}: the folder already holds {}", folder.display(), name.to_string_lossy());
                    return Err(CommandError::usage(problem, "give an empty folder, or the name of a new one"));
                }
            }
        }
        Ok(Self { folder, files: Vec::new() })
    }
}

/// The name of a picture; numbers count from 1.
fn name_of(number: usize) -> String {
    format!("frame-{number:05}.png")
}

/// The number in a picture's name.
fn number_of(name: &str) -> Option<usize> {
    let number = name.strip_prefix("frame-")?.strip_suffix(".png")?.parse().ok()?;
    (name_of(number) == name).then_some(number)
}

impl FilmWriter for FolderFilm {
    fn add_picture(&mut self, picture: &Image) -> Result<(), CommandError> {
        let file = self.folder.join(name_of(self.files.len() + 1));
        write_file(&file, picture::encode_png(picture)?)?;
        self.files.push(file);
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Vec<PathBuf>, CommandError> {
        Ok(self.files)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn number_of_reads_only_names_that_name_of_makes() {
        assert_eq!(number_of("frame-00012.png"), Some(12));
        assert_eq!(number_of("frame-123456.png"), Some(123_456));
        for other in ["frame-12.png", "frame-00012.jpg", "00012.png", "frame--0012.png", "frame-+0012.png"] {
            assert_eq!(number_of(other), None, "{other}");
        }
    }
}

//! Writes the files of the results into a folder.

use super::{Results, latex, markdown, page, sheet};
use crate::StudyError;
use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
};

impl Results {
    /// Writes the results into a folder: a page, Markdown, LaTeX, JSON, and the answers as CSV with a codebook. Files of an
    /// earlier call are replaced, each as a whole.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, StudyError> {
        fs::create_dir_all(folder).map_err(StudyError::io(folder, "make the folder"))?;
        self.files()?.into_iter().map(|(name, text)| write(folder, name, &text)).collect()
    }

    /// The files with their names, as [`Results::write`] writes them.
    ///
    /// # Errors
    /// When the page cannot be drawn.
    pub fn files(&self) -> Result<Vec<(&'static str, String)>, StudyError> {
        let json = serde_json::to_string_pretty(self).map_err(|error| {
            StudyError::refused(format!("results.json cannot be written: {error}"), "report this as a bug")
        })?;
        let codebook = sheet::codebook(&self.sheets);
        let mut files = vec![
            ("index.html", page::page(self, &self.sheets)?),
            ("results.md", markdown::markdown(self, &self.sheets)),
            ("results.tex", latex::latex(self)),
            ("results.json", json + "\n"),
        ];
        files.extend(self.sheets.iter().map(|sheet| (sheet.file, sheet.csv())));
        files.push((codebook.file, codebook.csv()));
        Ok(files)
    }
}

/// Writes a file under a temporary name and renames it, so that a crash leaves either the old file or the complete new one.
fn write(folder: &Path, name: &str, text: &str) -> Result<PathBuf, StudyError> {
    let place = folder.join(name);
    let beside = folder.join(format!(".{name}.part"));
    let written = fs::File::create(&beside).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.sync_all()?;
        fs::rename(&beside, &place)
    });
    written.map_err(StudyError::io(&place, "write"))?;
    Ok(place)
}

//! Writes the files of the results into a folder.

use super::{StudyReport, analysis_script, latex, markdown, page, sheet};
use crate::StudyError;
use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
};

impl StudyReport {
    /// Writes the results into a folder: a page, Markdown, LaTeX, JSON, and the answers as CSV with a codebook. Files of an
    /// earlier call are replaced, each as a whole.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn write_files(&self, folder: &Path) -> Result<Vec<PathBuf>, StudyError> {
        fs::create_dir_all(folder).map_err(StudyError::io_error(folder, "make the folder"))?;
        self.render_files()?.into_iter().map(|(name, text)| write_file(folder, name, &text)).collect()
    }

    /// The files with their names, as [`StudyReport::write_files`] writes them.
    ///
    /// # Errors
    /// When the page cannot be drawn.
    pub fn render_files(&self) -> Result<Vec<(&'static str, String)>, StudyError> {
        let json = serde_json::to_string_pretty(self).map_err(|error| {
            StudyError::refused_request(format!("results.json cannot be written: {error}"), "report this as a bug")
        })?;
        let codebook = sheet::codebook_sheet(&self.sheets);
        let mut files = vec![
            ("index.html", page::render_page(self, &self.sheets)?),
            ("results.md", markdown::render_markdown(self, &self.sheets)),
            ("results.tex", latex::render_latex(self)),
            ("results.json", json + "\n"),
        ];
        files.extend(self.sheets.iter().map(|sheet| (sheet.file, sheet.to_csv())));
        files.push((codebook.file, codebook.to_csv()));
        files.push(("analysis.R", analysis_script::render_script(self)));
        Ok(files)
    }
}

/// Writes a file under a temporary name and renames it, so that a crash leaves either the old file or the complete new one.
fn write_file(folder: &Path, name: &str, text: &str) -> Result<PathBuf, StudyError> {
    let place = folder.join(name);
    let temporary = folder.join(format!(".{name}.part"));
    let written = fs::File::create(&temporary).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.sync_all()?;
        fs::rename(&temporary, &place)
    });
    if written.is_err() {
        // The first failure is the one to report.
        let _ = fs::remove_file(&temporary);
    }
    written.map_err(StudyError::io_error(&place, "write"))?;
    Ok(place)
}

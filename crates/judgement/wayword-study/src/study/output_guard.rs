//! Keeps outputs that are made to be passed on out of the private folders of studies.

use super::{Study, StudyError, folder::SETTINGS_FILE};
use std::{fs, io::Write as _, path::Path};

impl Study {
    /// Refuses an output inside the folder of a study, which has the answers of people and pictures of others, while outputs are made to be
    /// passed on. `flag` names the output, as in `--out`.
    ///
    /// # Errors
    /// When the output would lie in a study, or a folder on the way to it cannot be read.
    pub fn check_outside(flag: &str, output: &Path) -> Result<(), StudyError> {
        let absolute = std::path::absolute(output).map_err(StudyError::io_error(output, "find"))?;
        // Links on the way are followed as far as there is anything, so that none leads into a study unseen.
        let known = absolute.ancestors().find_map(|folder| fs::canonicalize(folder).ok());
        let written = absolute.ancestors().map(Path::to_owned);
        let mut folders = written.chain(known.iter().flat_map(|known| known.ancestors().map(Path::to_owned)));
        match folders.find(|folder| Self::is_in(folder) && folder.join(SETTINGS_FILE).is_file()) {
            Some(study) => Err(StudyError::refused_request(
                format!(
                    "{flag} {}: it is in the study {}, whose folder is private: it has the answers of people",
                    output.display(),
                    study.display()
                ),
                format!("give {flag} another place, beside the study"),
            )),
            None => Ok(()),
        }
    }

    /// Refuses a name for a new file that is taken, or lies in the folder of a study.
    ///
    /// # Errors
    /// When it is one of these.
    pub fn check_new_file(flag: &str, file: &Path) -> Result<(), StudyError> {
        Self::check_outside(flag, file)?;
        if fs::symlink_metadata(file).is_ok() {
            let problem = format!("{flag} {}: there is something of this name already", file.display());
            return Err(StudyError::refused_request(problem, "give the name of a new file, or move the old one away"));
        }
        Ok(())
    }

    /// Writes a new file about the study that its researcher keeps.
    ///
    /// # Errors
    /// When the file exists or lies in a study, or cannot be written.
    pub(crate) fn write_new_file(path: &Path, text: &str) -> Result<(), StudyError> {
        Self::check_outside("--out", path)?;
        let written = fs::File::options().write(true).create_new(true).open(path).and_then(|mut file| {
            file.write_all(text.as_bytes())?;
            file.sync_all()
        });
        written.map_err(StudyError::io_error(path, "write the new file"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_output_lands_in_a_study() {
        let around = tempfile::tempdir().unwrap();
        let study = around.path().join("study");
        fs::create_dir_all(study.join("pictures")).unwrap();
        for name in ["plan.json", SETTINGS_FILE] {
            fs::write(study.join(name), "").unwrap();
        }
        let mut inside = vec![study.clone(), study.join("pictures"), study.join("new/deep"), study.join("sheet.md")];
        inside.push(study.join("pictures/../tables"));
        #[cfg(unix)]
        {
            let link = around.path().join("link");
            std::os::unix::fs::symlink(study.join("pictures"), &link).unwrap();
            inside.extend([link.clone(), link.join("tables")]);
        }
        for output in inside {
            let told = Study::check_outside("--out", &output).unwrap_err().to_string();
            assert!(told.contains("--out") && told.contains("private"), "{told}");
        }
        for output in ["tables", "study-tables", "deep/new"] {
            Study::check_outside("--out", &around.path().join(output)).unwrap();
        }
        assert!(
            Study::check_new_file("--out", &study.join(SETTINGS_FILE)).unwrap_err().to_string().contains("private")
        );
        fs::write(around.path().join("taken"), "").unwrap();
        let taken = Study::check_new_file("--out", &around.path().join("taken")).unwrap_err().to_string();
        assert!(taken.contains("already") && taken.contains("new file"), "{taken}");
    }
}

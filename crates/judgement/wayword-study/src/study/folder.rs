//! Writes and reads the folder of a study.

use super::{PageTexts, StudyDesign, StudyError, StudyItem, StudyRoute, StudyScene, StudySettings};
use serde::{Serialize, de::DeserializeOwned};
use std::{
    fs,
    io::{self, Write},
    path::{Path, PathBuf},
};

/// The plan, which is fixed when the study is made.
const PLAN_FILE: &str = "plan.json";
/// The wording, which the researcher may change.
pub(super) const SETTINGS_FILE: &str = "study.toml";
/// The words of the pages, where they were translated.
const TEXTS_FILE: &str = "texts.toml";
/// Largest file of words, bytes.
const MAX_TEXTS_BYTES: u64 = 1 << 20;
const ITEMS_FILE: &str = "items.jsonl";
const ROUTES_FILE: &str = "routes.jsonl";
const SCENES_FILE: &str = "scenes.jsonl";
/// The answers.
const DATABASE_FILE: &str = "study.db";
const PICTURES_FOLDER: &str = "pictures";
/// Largest file of a study that is read, bytes. A larger one is an error.
const MAX_STUDY_FILE_BYTES: u64 = 1 << 30;

/// A study as it was made, without the answers.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Its folder.
    pub folder: PathBuf,
    /// The plan, which is fixed when the study is made.
    pub plan: StudyDesign,
    /// Wording and other settings.
    pub settings: StudySettings,
    /// The words of the pages.
    pub texts: PageTexts,
    /// All items, by id.
    pub items: Vec<StudyItem>,
    /// All routes, by id.
    pub routes: Vec<StudyRoute>,
    /// The scenes that people walk.
    pub scenes: Vec<StudyScene>,
}

impl Study {
    /// Writes the files of a new study except its plan and its database.
    ///
    /// # Errors
    /// When there is a study already, or a file cannot be written.
    pub(crate) fn write_contents(&self) -> Result<(), StudyError> {
        if self.folder.join(PLAN_FILE).exists() {
            let problem = format!("{}: there is a study already", self.folder.display());
            return Err(StudyError::refused_request(
                problem,
                "give another --out; a study that people see is not changed",
            ));
        }
        fs::create_dir_all(self.folder.join(PICTURES_FOLDER))
            .map_err(StudyError::io_error(&self.folder, "make the folder"))?;
        keep_private(&self.folder)?;
        self.write_lines(ITEMS_FILE, &self.items)?;
        self.write_lines(ROUTES_FILE, &self.routes)?;
        self.write_lines(SCENES_FILE, &self.scenes)?;
        if !self.texts.is_english() {
            let texts = self.texts.to_file().map_err(|problem| wrong_file_error(&self.folder, TEXTS_FILE, &problem))?;
            self.write_file(TEXTS_FILE, texts.as_bytes())?;
        }
        let settings = toml::to_string_pretty(&self.settings)
            .map_err(|error| wrong_file_error(&self.folder, SETTINGS_FILE, &error))?;
        self.write_file(SETTINGS_FILE, settings.as_bytes())
    }

    /// Writes the plan, which completes a new study.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(crate) fn write_plan(&self) -> Result<(), StudyError> {
        let plan = self.plan.to_file().map_err(|error| wrong_file_error(&self.folder, PLAN_FILE, &error))?;
        self.write_file(PLAN_FILE, &plan)
    }

    /// Whether a folder holds a study.
    #[must_use]
    pub fn is_in(folder: &Path) -> bool {
        folder.join(PLAN_FILE).is_file()
    }

    /// Reads a study.
    ///
    /// # Errors
    /// When the folder holds none, or a file of it cannot be used.
    pub fn open(folder: &Path) -> Result<Self, StudyError> {
        let read = |name: &str| read_limited_file(folder, name);
        check_folder(folder)?;
        let plan = StudyDesign::from_file(&read(PLAN_FILE)?)
            .map_err(|problem| wrong_file_error(folder, PLAN_FILE, &problem))?;
        let settings: StudySettings = toml::from_str(&read(SETTINGS_FILE)?)
            .map_err(|error| wrong_file_error(folder, SETTINGS_FILE, &settings_problem(&error)))?;
        settings.check().map_err(|problem| wrong_file_error(folder, SETTINGS_FILE, &problem))?;
        let texts = folder.join(TEXTS_FILE);
        let texts = if texts.exists() { PageTexts::read(&texts)? } else { PageTexts::default() };
        let study = Self {
            plan,
            settings,
            texts,
            items: read_json_lines(folder, ITEMS_FILE)?,
            routes: read_json_lines(folder, ROUTES_FILE)?,
            scenes: read_json_lines(folder, SCENES_FILE)?,
            folder: folder.to_owned(),
        };
        study.check_numbering()?;
        Ok(study)
    }

    /// Where its pictures are.
    #[must_use]
    pub fn pictures_folder(&self) -> PathBuf {
        self.folder.join(PICTURES_FOLDER)
    }

    /// All words that participants read before they consent: those of `study.toml`, and what is recorded beside the answers.
    pub(crate) fn consent_words(&self) -> Vec<&str> {
        let mut words = self.settings.consent_words();
        words.push(self.texts.recorded_words(self.plan.mode));
        words
    }

    /// Its database.
    pub(crate) fn database_file(&self) -> PathBuf {
        self.folder.join(DATABASE_FILE)
    }

    /// The scene of a route.
    #[must_use]
    pub fn scene_of(&self, route: &StudyRoute) -> Option<&StudyScene> {
        self.scenes.iter().find(|scene| scene.scene == route.scene)
    }

    /// Checks that ids equal line numbers, because items and routes are found by index.
    fn check_numbering(&self) -> Result<(), StudyError> {
        let check_ids = |name: &str, ids: Vec<u32>| match (0..).zip(&ids).find(|(number, id)| number != *id) {
            Some((number, _)) => {
                Err(wrong_file_error(&self.folder, name, &format!("line {}: its id must be {number}", number + 1)))
            }
            None => Ok(()),
        };
        check_ids(ITEMS_FILE, self.items.iter().map(|item| item.id).collect())?;
        check_ids(ROUTES_FILE, self.routes.iter().map(|route| route.id).collect())?;
        if let Some(item) =
            self.items.iter().find(|item| item.route as usize >= self.routes.len() || item.texts.is_empty())
        {
            return Err(wrong_file_error(
                &self.folder,
                ITEMS_FILE,
                &format!("item {}: it has no route or no text", item.id),
            ));
        }
        Ok(())
    }

    /// Writes a file of JSON lines, one for each record.
    fn write_lines<T: Serialize>(&self, name: &str, records: &[T]) -> Result<(), StudyError> {
        let mut text = Vec::new();
        for record in records {
            serde_json::to_writer(&mut text, record).map_err(|error| wrong_file_error(&self.folder, name, &error))?;
            text.push(b'\n');
        }
        self.write_file(name, &text)
    }

    /// Writes a file under a temporary name and renames it, so that it is complete or does not exist.
    fn write_file(&self, name: &str, bytes: &[u8]) -> Result<(), StudyError> {
        let place = self.folder.join(name);
        let temporary = self.folder.join(format!(".{name}.part"));
        let written = fs::File::create(&temporary).and_then(|mut file| {
            file.write_all(bytes)?;
            file.sync_all()?;
            fs::rename(&temporary, &place)
        });
        if written.is_err() {
            // The first failure is the one to report.
            let _ = fs::remove_file(&temporary);
        }
        written.map_err(StudyError::io_error(place, "write"))
    }
}

/// Refuses a folder that has no study, or that this user may not read.
fn check_folder(folder: &Path) -> Result<(), StudyError> {
    let plan = folder.join(PLAN_FILE);
    let refuse =
        |problem: &str, hint: &str| Err(StudyError::refused_request(format!("{}: {problem}", folder.display()), hint));
    match fs::metadata(&plan) {
        Ok(about) if about.is_file() => Ok(()),
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => refuse(
            "you may not read this folder (permission denied)",
            "only the one who made a study can read its folder: run the command as that user",
        ),
        Err(error) if ![io::ErrorKind::NotFound, io::ErrorKind::NotADirectory].contains(&error.kind()) => {
            Err(StudyError::Io { path: plan, doing: "read", source: error })
        }
        _ => match fs::metadata(folder) {
            Ok(about) if about.is_dir() => refuse(
                "this folder holds no study (it has no plan.json)",
                "give the folder that `wayword study new --out` named",
            ),
            Ok(_) => {
                refuse("this is no folder, and a study is one", "give the folder that `wayword study new --out` named")
            }
            Err(_) => refuse("there is no such folder", "check the name; `wayword study new` makes a study"),
        },
    }
}

/// Lets only the owner into a folder, because it will contain people's answers.
fn keep_private(folder: &Path) -> Result<(), StudyError> {
    #[cfg(unix)]
    {
        let mode = std::os::unix::fs::PermissionsExt::from_mode(0o700);
        fs::set_permissions(folder, mode).map_err(StudyError::io_error(folder, "restrict access to"))?;
    }
    #[cfg(not(unix))]
    let _ = folder;
    Ok(())
}

/// What is wrong in `study.toml`, with the type of a number in plain words.
fn settings_problem(error: &toml::de::Error) -> String {
    let told = error.to_string();
    ["u32", "u64", "usize"].iter().fold(told.trim_end().to_owned(), |told, type_name| {
        told.replace(&format!(", expected {type_name}"), "; give a whole number, 0 or more")
    })
}

/// An error about the contents of a file of the study, with advice.
fn wrong_file_error(folder: &Path, name: &str, problem: &dyn std::fmt::Display) -> StudyError {
    let hint = if name == SETTINGS_FILE {
        "correct it; docs/STUDY.md lists its keys"
    } else {
        "put back the file as `study new` wrote it, or use the version of this program that made the study"
    };
    StudyError::File { path: folder.join(name), problem: problem.to_string(), hint }
}

impl PageTexts {
    /// Reads a file of words.
    ///
    /// # Errors
    /// When it cannot be read, or a text is missing, unknown, or has other placeholders than the English one.
    pub fn read(path: &Path) -> Result<Self, StudyError> {
        let wrong = |problem: String| StudyError::File {
            path: path.to_owned(),
            problem,
            hint: "`wayword study texts` writes all texts in English; translate what stands right of the equals signs",
        };
        let size = fs::metadata(path).map_err(StudyError::io_error(path, "read"))?.len();
        if size > MAX_TEXTS_BYTES {
            return Err(wrong(format!("it has {size} bytes, and at most {MAX_TEXTS_BYTES} are read")));
        }
        let text = fs::read_to_string(path).map_err(StudyError::io_error(path, "read"))?;
        Self::parse(&text).map_err(wrong)
    }
}

/// Reads a text file of the study, unless it is missing or too large.
fn read_limited_file(folder: &Path, name: &str) -> Result<String, StudyError> {
    let path = folder.join(name);
    if !path.exists() {
        return Err(wrong_file_error(folder, name, &"this file of the study is missing"));
    }
    let size = fs::metadata(&path).map_err(StudyError::io_error(&path, "read"))?.len();
    if size > MAX_STUDY_FILE_BYTES {
        let problem = format!("it has {size} bytes, and at most {MAX_STUDY_FILE_BYTES} are read");
        return Err(StudyError::File { path, problem, hint: "make a smaller study" });
    }
    fs::read_to_string(&path).map_err(StudyError::io_error(&path, "read"))
}

/// Reads a file of JSON lines. An error names the line.
fn read_json_lines<T: DeserializeOwned>(folder: &Path, name: &str) -> Result<Vec<T>, StudyError> {
    let text = read_limited_file(folder, name)?;
    let parse = |(number, line): (usize, &str)| {
        serde_json::from_str(line)
            .map_err(|error| wrong_file_error(folder, name, &format!("line {}: {error}", number + 1)))
    };
    text.lines().enumerate().map(parse).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(folder: &Path) -> String {
        Study::open(folder).unwrap_err().to_string()
    }

    #[test]
    fn what_is_no_study_is_told_apart() {
        let around = tempfile::tempdir().unwrap();
        let (file, empty) = (around.path().join("file"), around.path().join("empty"));
        fs::write(&file, "").unwrap();
        fs::create_dir(&empty).unwrap();
        assert!(refused(&around.path().join("gone")).contains("there is no such folder"));
        assert!(refused(&empty).contains("this folder holds no study"));
        assert!(refused(&file).contains("this is no folder"));
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_that_one_may_not_read_is_not_called_empty() {
        use std::os::unix::fs::PermissionsExt;
        let around = tempfile::tempdir().unwrap();
        let closed = around.path().join("study");
        fs::create_dir(&closed).unwrap();
        fs::set_permissions(&closed, PermissionsExt::from_mode(0o000)).unwrap();
        // The superuser may read everything.
        if fs::read_dir(&closed).is_err() {
            assert!(refused(&closed).contains("permission denied"), "{}", refused(&closed));
        }
        fs::set_permissions(&closed, PermissionsExt::from_mode(0o700)).unwrap();
    }
}

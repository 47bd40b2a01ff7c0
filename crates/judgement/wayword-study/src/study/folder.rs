//! Creates and reads the folder of a study.

use super::{Item, Plan, Route, Scene, Settings, StudyError};
use crate::store::Store;
use serde::{Serialize, de::DeserializeOwned};
use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
};

/// The plan, which is fixed when the study is made.
const PLAN: &str = "plan.json";
/// The wording, which the researcher may change.
const SETTINGS: &str = "study.toml";
const ITEMS: &str = "items.jsonl";
const ROUTES: &str = "routes.jsonl";
const SCENES: &str = "scenes.jsonl";
/// The answers.
const DATABASE: &str = "study.db";
const PICTURES: &str = "pictures";
/// Largest file that is read, bytes.
const MOST_BYTES: u64 = 1 << 30;

/// A study as it was made, without the answers.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Its folder.
    pub folder: PathBuf,
    /// The plan, which is fixed when the study is made.
    pub plan: Plan,
    /// Wording and other settings.
    pub settings: Settings,
    /// All items, by id.
    pub items: Vec<Item>,
    /// All routes, by id.
    pub routes: Vec<Route>,
    /// The scenes that people walk.
    pub scenes: Vec<Scene>,
}

impl Study {
    /// Writes a new study. Its folder `pictures` already has the pictures. The plan is written last, so a folder without a plan is not
    /// a complete study.
    ///
    /// # Errors
    /// When there is one already, or a file cannot be written.
    pub fn create(&self) -> Result<(), StudyError> {
        if self.folder.join(PLAN).exists() {
            let problem = format!("{}: there is a study already", self.folder.display());
            return Err(StudyError::refused(problem, "give another --out; a study that people see is not changed"));
        }
        fs::create_dir_all(self.folder.join(PICTURES)).map_err(StudyError::io(&self.folder, "make the folder"))?;
        keep_private(&self.folder)?;
        self.write_lines(ITEMS, &self.items)?;
        self.write_lines(ROUTES, &self.routes)?;
        self.write_lines(SCENES, &self.scenes)?;
        let settings = toml::to_string_pretty(&self.settings).map_err(|error| self.wrong(SETTINGS, &error))?;
        self.write(SETTINGS, settings.as_bytes())?;
        Store::open(&self.database())?;
        let plan = self.plan.to_file().map_err(|error| self.wrong(PLAN, &error))?;
        self.write(PLAN, &plan)
    }

    /// Whether a folder holds a study.
    #[must_use]
    pub fn is_in(folder: &Path) -> bool {
        folder.join(PLAN).is_file()
    }

    /// Reads a study.
    ///
    /// # Errors
    /// When the folder holds none, or a file of it cannot be used.
    pub fn open(folder: &Path) -> Result<Self, StudyError> {
        let read = |name: &str| read(&folder.join(name));
        if !folder.join(PLAN).is_file() {
            let problem = format!("{}: there is no study (no {PLAN})", folder.display());
            return Err(StudyError::refused(problem, "`wayword study new` makes one"));
        }
        let plan = Plan::from_file(&read(PLAN)?).map_err(|problem| wrong(folder, PLAN, &problem))?;
        let settings: Settings = toml::from_str(&read(SETTINGS)?).map_err(|error| wrong(folder, SETTINGS, &error))?;
        settings.check().map_err(|problem| wrong(folder, SETTINGS, &problem))?;
        let study = Self {
            plan,
            settings,
            items: lines(folder, ITEMS)?,
            routes: lines(folder, ROUTES)?,
            scenes: lines(folder, SCENES)?,
            folder: folder.to_owned(),
        };
        study.check()?;
        Ok(study)
    }

    /// Where its pictures are.
    #[must_use]
    pub fn pictures(&self) -> PathBuf {
        self.folder.join(PICTURES)
    }

    /// Its database.
    pub(crate) fn database(&self) -> PathBuf {
        self.folder.join(DATABASE)
    }

    /// The scene of a route.
    #[must_use]
    pub fn scene_of(&self, route: &Route) -> Option<&Scene> {
        self.scenes.iter().find(|scene| scene.scene == route.scene)
    }

    /// Checks that ids equal line numbers, because items and routes are found by index.
    fn check(&self) -> Result<(), StudyError> {
        let numbered = |name: &str, ids: Vec<u32>| match (0..).zip(&ids).find(|(number, id)| number != *id) {
            Some((number, _)) => {
                Err(wrong(&self.folder, name, &format!("line {}: its id must be {number}", number + 1)))
            }
            None => Ok(()),
        };
        numbered(ITEMS, self.items.iter().map(|item| item.id).collect())?;
        numbered(ROUTES, self.routes.iter().map(|route| route.id).collect())?;
        if let Some(item) =
            self.items.iter().find(|item| item.route as usize >= self.routes.len() || item.texts.is_empty())
        {
            return Err(wrong(&self.folder, ITEMS, &format!("item {}: it has no route or no text", item.id)));
        }
        Ok(())
    }

    fn write_lines<T: Serialize>(&self, name: &str, all: &[T]) -> Result<(), StudyError> {
        let mut text = Vec::new();
        for one in all {
            serde_json::to_writer(&mut text, one).map_err(|error| self.wrong(name, &error))?;
            text.push(b'\n');
        }
        self.write(name, &text)
    }

    /// Writes a file under a temporary name and renames it, so that it is complete or does not exist.
    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), StudyError> {
        let place = self.folder.join(name);
        let beside = self.folder.join(format!(".{name}.part"));
        let written = fs::File::create(&beside).and_then(|mut file| {
            file.write_all(bytes)?;
            file.sync_all()?;
            fs::rename(&beside, &place)
        });
        written.map_err(StudyError::io(place, "write"))
    }

    fn wrong(&self, name: &str, problem: &dyn std::fmt::Display) -> StudyError {
        wrong(&self.folder, name, problem)
    }
}

/// Lets only the owner into a folder, because it will contain people's answers.
fn keep_private(folder: &Path) -> Result<(), StudyError> {
    #[cfg(unix)]
    {
        let mode = std::os::unix::fs::PermissionsExt::from_mode(0o700);
        fs::set_permissions(folder, mode).map_err(StudyError::io(folder, "restrict access to"))?;
    }
    #[cfg(not(unix))]
    let _ = folder;
    Ok(())
}

fn wrong(folder: &Path, name: &str, problem: &dyn std::fmt::Display) -> StudyError {
    let hint = if name == SETTINGS {
        "correct it; docs/STUDY.md lists its keys"
    } else {
        "put back the file as `study new` wrote it, or use the version of this program that made the study"
    };
    StudyError::File { path: folder.join(name), problem: problem.to_string(), hint }
}

fn read(path: &Path) -> Result<String, StudyError> {
    let size = fs::metadata(path).map_err(StudyError::io(path, "read"))?.len();
    if size > MOST_BYTES {
        let problem = format!("it has {size} bytes, and at most {MOST_BYTES} are read");
        return Err(StudyError::File { path: path.to_owned(), problem, hint: "make a smaller study" });
    }
    fs::read_to_string(path).map_err(StudyError::io(path, "read"))
}

fn lines<T: DeserializeOwned>(folder: &Path, name: &str) -> Result<Vec<T>, StudyError> {
    let text = read(&folder.join(name))?;
    let parse = |(number, line): (usize, &str)| {
        serde_json::from_str(line).map_err(|error| wrong(folder, name, &format!("line {}: {error}", number + 1)))
    };
    text.lines().enumerate().map(parse).collect()
}

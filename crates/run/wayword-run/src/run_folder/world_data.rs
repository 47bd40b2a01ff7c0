//! Hashes of the files that a run's scenes are read from, so that a run is not continued after these files have changed.

use super::{Sha256, file, short_hex};
use crate::{error::CommandError, text_file, written_files::write_file};
use sha2::Digest;
use std::{
    collections::BTreeMap,
    fs::{self, File},
    io::{self, Read, Seek, SeekFrom},
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
};
use wayword_core::{Platform, PlatformError, SceneId};

/// A file up to this size, bytes, is hashed whole; of a larger one only its beginning, middle and end are hashed.
const MAX_WHOLE_BYTES: u64 = 8 << 20;
/// Size of each of these three samples, bytes.
const SAMPLE_BYTES: u64 = 64 << 10;
/// How much of the beginning of a picture is hashed, bytes, because a scene may have thousands of pictures. The length
/// of the file is hashed too.
const PICTURE_HEAD_BYTES: u64 = 4 << 10;

/// The hint with a file that cannot be read.
const UNREADABLE_HINT: &str = "make sure that you may read it, or move it away";

/// The hashes of a run's scenes: those in its folder (`data.json`), and those of the files as they are now.
#[derive(Debug)]
pub struct WorldData {
    path: PathBuf,
    /// For a run of many workers, the hashes in its plan and the file of the plan.
    planned: Option<(BTreeMap<String, String>, PathBuf)>,
    state: Mutex<SceneHashes>,
}

/// The hashes of scenes, by the names of the scenes.
#[derive(Debug, Default)]
struct SceneHashes {
    /// The hashes in the folder.
    kept: BTreeMap<String, String>,
    /// The hashes of the files now; `None` for a scene that is read from no file.
    now: BTreeMap<String, Option<String>>,
    /// The hash of each file, because several scenes may share one.
    files: BTreeMap<PathBuf, String>,
}

impl WorldData {
    /// The hashes that a run folder holds.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn from_folder(folder: &Path) -> Result<Self, CommandError> {
        let path = folder.join(file::DATA);
        let kept = if path.exists() {
            let text = text_file::read_text_file(&path, "read the hashes of the scenes")?;
            serde_json::from_str(&text).map_err(|error| {
                let hint = "the file was changed by hand or by another program: give another --out for a new run";
                CommandError::usage(format!("{}: {error}", path.display()), hint)
            })?
        } else {
            BTreeMap::new()
        };
        Ok(Self { path, planned: None, state: Mutex::new(SceneHashes { kept, ..SceneHashes::default() }) })
    }

    /// The same, and scenes that differ from those of a plan are refused as well.
    #[must_use]
    pub(crate) fn with_planned_hashes(self, planned: &BTreeMap<String, String>, file: &Path) -> Self {
        Self { planned: Some((planned.clone(), file.to_owned())), ..self }
    }

    /// Refuses a scene if its files have changed since the run began.
    ///
    /// # Errors
    /// When the files are others, or cannot be read.
    pub fn check_scene(&self, platform: &dyn Platform, scene: &SceneId) -> Result<(), CommandError> {
        let mut state = self.lock_state();
        if !state.now.contains_key(scene.as_str()) {
            let files = platform.files().source_files(scene)?;
            let now = if files.is_empty() { None } else { Some(state.hash_files(&files)?) };
            state.now.insert(scene.to_string(), now);
        }
        let (kept, now) = (state.kept.get(scene.as_str()), state.now.get(scene.as_str()).cloned().flatten());
        if kept.is_some() && kept != now.as_ref() {
            return Err(CommandError::ChangedScene { scene: scene.to_string(), record: self.path.clone() });
        }
        if let Some((planned, file)) = &self.planned {
            let planned = planned.get(scene.as_str());
            if planned.is_some() && planned != now.as_ref() {
                return Err(CommandError::ChangedScene { scene: scene.to_string(), record: file.clone() });
            }
        }
        Ok(())
    }

    /// Writes the hash of a scene into the folder, before the scene's first item is written.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn keep_scene(&self, scene: &SceneId) -> Result<(), CommandError> {
        let mut state = self.lock_state();
        let Some(now) = state.now.get(scene.as_str()).cloned().flatten() else { return Ok(()) };
        if state.kept.insert(scene.to_string(), now).is_some() {
            return Ok(());
        }
        let text = serde_json::to_string_pretty(&state.kept).unwrap_or_default();
        write_file(&self.path, &text)
    }

    fn lock_state(&self) -> MutexGuard<'_, SceneHashes> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The hashes of scenes' files, by scene. Scenes that are read from no file are left out.
///
/// # Errors
/// When a file cannot be read.
pub(crate) fn scene_hashes<'a>(
    platform: &dyn Platform,
    scenes: impl IntoIterator<Item = &'a SceneId>,
) -> Result<BTreeMap<String, String>, CommandError> {
    let mut state = SceneHashes::default();
    let mut hashes = BTreeMap::new();
    for scene in scenes {
        let files = platform.files().source_files(scene)?;
        if !files.is_empty() {
            hashes.insert(scene.to_string(), state.hash_files(&files)?);
        }
    }
    Ok(hashes)
}

impl SceneHashes {
    /// One hash for the names and contents of all files of a scene.
    fn hash_files(&mut self, files: &[PathBuf]) -> Result<String, PlatformError> {
        let mut hash = Sha256::new();
        for file in files {
            if !self.files.contains_key(file) {
                let file_hash = hash_scene_file(file)
                    .map_err(|error| PlatformError::for_unread_file(file, &error, UNREADABLE_HINT))?;
                self.files.insert(file.clone(), file_hash);
            }
            hash.update(file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default());
            hash.update(&self.files[file]);
        }
        Ok(short_hex(hash))
    }
}

/// The hash of a file. Of a large file it takes only samples, which are enough to recognise another file.
fn hash_scene_file(path: &Path) -> io::Result<String> {
    // Reading a pipe would wait for ever.
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::other("it is not a plain file"));
    }
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    let mut hash = Sha256::new();
    hash.update(length.to_le_bytes());
    let is_picture = path.extension().is_some_and(|ending| ["jpg", "jpeg", "png"].iter().any(|known| ending == *known));
    if is_picture {
        io::copy(&mut file.take(PICTURE_HEAD_BYTES), &mut hash)?;
    } else if length <= MAX_WHOLE_BYTES {
        io::copy(&mut file, &mut hash)?;
    } else {
        for start in [0, (length - SAMPLE_BYTES) / 2, length - SAMPLE_BYTES] {
            file.seek(SeekFrom::Start(start))?;
            io::copy(&mut file.by_ref().take(SAMPLE_BYTES), &mut hash)?;
        }
    }
    Ok(short_hex(hash))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hash_scene_file_a_large_file_depends_on_its_end_and_length() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.glb");
        let mut bytes = vec![7; MAX_WHOLE_BYTES as usize + 5];
        fs::write(&path, &bytes).unwrap();
        let before = hash_scene_file(&path).unwrap();
        assert_eq!(hash_scene_file(&path).unwrap(), before);
        *bytes.last_mut().unwrap() = 8;
        fs::write(&path, &bytes).unwrap();
        let other_end = hash_scene_file(&path).unwrap();
        bytes.push(8);
        fs::write(&path, &bytes).unwrap();
        assert!(other_end != before && hash_scene_file(&path).unwrap() != before);
    }
}
